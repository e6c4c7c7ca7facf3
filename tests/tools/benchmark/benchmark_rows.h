#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "tools/benchmark/benchmark.h"

// Tables of the benchmark for the shipped rig, and invented rows of results.

namespace flexarm {

inline constexpr const char* kExperiments = FLEXARM_SOURCE_DIR "/config/experiments";

inline const RigConfig& Rig() {
  static const RigConfig rig = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml");
  return rig;
}

inline SweepPlan Plan(const std::string& laws, const std::string& seeds,
                      BenchmarkKind kind = BenchmarkKind::kCommands) {
  return BenchmarkPlan(Rig(), BenchmarkSetOf(kind, Rig(), kExperiments), laws, seeds);
}

inline BenchmarkTable Table(const SweepPlan& plan, const std::vector<SweepRow>& rows,
                            BenchmarkKind kind = BenchmarkKind::kCommands) {
  return TableOf({.kind = kind, .scenarios = {}, .laws = {}, .seeds = {}}, plan, rows);
}

/// A completed run; every measure except the settling time is 1.
inline SweepRow Made(std::size_t point, double settling_s) {
  SweepRow row{.point = point, .completed = true, .trip = {}, .refused = {}, .ticks = 801};
  row.measure.fill(1.0);
  row.measure[kSettling] = settling_s;
  return row;
}

/// Five runs: settled at once, late, never, tripped, and settled at the limit.
inline std::vector<SweepRow> FiveRuns() {
  std::vector<SweepRow> rows = {Made(0, 0.0), Made(1, 0.32), Made(2, std::nan("")), Made(3, 0.0),
                                Made(4, 0.3)};
  rows[0].measure[kResidual] = 2.0;
  rows[0].measure[kMotion] = 5.0;
  rows[1].measure[kTargetError] = 7.0;
  rows[1].measure[kRms1] = 3.0;
  rows[2].measure[kRms2] = 9.0;
  rows[3].completed = false;
  rows[3].trip = "bending-strain-1";
  rows[3].measure.fill(1000.0);
  return rows;
}

/// One run of each of two laws. The first settles after 0.7 s, and trips in the fourth scenario;
/// the second after 1.4 s, but in the tenth, `waypoints` of the commands, after three quarters of
/// its rest of 6.4 s. The measures of the first are 1, 2, .., of the second 11, 12, .. .
inline std::vector<SweepRow> OneEach(const SweepPlan& plan) {
  std::vector<SweepRow> rows;
  for (std::size_t point = 0; point < plan.grid.size(); ++point) {
    const std::size_t law = point / plan.scenarios.size(), scenario = point % plan.scenarios.size();
    SweepRow row = Made(point, 0.0);
    for (std::size_t i = 0; i < row.measure.size(); ++i) {
      row.measure[i] = static_cast<double>(10 * law + i + 1);
    }
    row.measure[kSettling] = law == 0 ? 0.7 : scenario == 9 ? 4.8 : 1.4;
    row.completed = law == 1 || scenario != 3;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace flexarm
