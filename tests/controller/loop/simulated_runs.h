#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/host/simulation.h"
#include "controller/types/trip_cause.h"
#include "tests/controller/law/shipped_rig.h"

// Runs of the complete stack (Simulate), and the quantities with acceptance limits (bars).

namespace flexarm {

inline constexpr int kSeeds = 11;  // the bars are for seeds 1 to 11

inline Experiment ShippedExperiment(const std::string& name = "square-30deg") {
  return LoadExperiment(FLEXARM_SOURCE_DIR "/config/experiments/" + name + ".toml");
}

/// Sets the payload of the simulated arm from `at_s` on.
inline SimEvent PayloadEvent(double at_s, double payload_kg) {
  return {.at_s = at_s,
          .line = {},
          .level = 0,
          .freeze = FreezeTarget::kNone,
          .kill = false,
          .payload_kg = payload_kg};
}

/// One run of the shipped rig with `overrides`.
inline SimulationResult Run(double payload_kg, std::uint64_t seed,
                            std::vector<std::string> overrides = {},
                            const std::string& experiment = "square-30deg") {
  overrides.push_back("sim.seed=" + std::to_string(seed));
  return Simulate({.config = ShippedRig(overrides),
                   .experiment = ShippedExperiment(experiment),
                   .payload_kg = payload_kg,
                   .log = {}});
}

/// Figures of the same run with several seeds.
struct Runs {
  std::vector<double> rms1_deg, rms2_deg, final1_deg, final2_deg, settling_s, residual_mm, peak1_nm,
      peak2_nm;
  int tripped = 0;
  std::vector<TripCause> trip;
};

inline void Add(const SimulationResult& result, Runs* runs) {
  const RunMetrics& m = result.metrics;
  runs->rms1_deg.push_back(m.joint_rms_error_deg[0]);
  runs->rms2_deg.push_back(m.joint_rms_error_deg[1]);
  runs->final1_deg.push_back(m.joint_final_error_deg[0]);
  runs->final2_deg.push_back(m.joint_final_error_deg[1]);
  runs->settling_s.push_back(
      m.tip_settling_time_s.value_or(std::numeric_limits<double>::infinity()));
  runs->residual_mm.push_back(m.tip_residual_rms_mm);
  runs->peak1_nm.push_back(m.peak_torque_nm[0]);
  runs->peak2_nm.push_back(m.peak_torque_nm[1]);
  if (!result.completed) ++runs->tripped;
  runs->trip.push_back(result.trip);
}

inline Runs RunSeeds(double payload_kg, const std::vector<std::string>& overrides = {},
                     int seeds = kSeeds, const std::string& experiment = "square-30deg") {
  Runs runs;
  for (int seed = 1; seed <= seeds; ++seed) {
    Add(Run(payload_kg, static_cast<std::uint64_t>(seed), overrides, experiment), &runs);
  }
  return runs;
}

/// Runs whose tip is at rest 0.3 s after every move, t15 <= 0.3 s.
inline int SettledInTime(const Runs& runs) {
  return static_cast<int>(std::count_if(runs.settling_s.begin(), runs.settling_s.end(),
                                        [](double time_s) { return time_s <= 0.3; }));
}

inline double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

inline double Largest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

}  // namespace flexarm
