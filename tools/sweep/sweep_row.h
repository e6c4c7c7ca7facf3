#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "controller/host/simulation.h"

namespace flexarm {

/// A figure of a run that a sweep stores, in the order of SweepRow::measure.
struct SweepMeasure {
  const char* column;  ///< column of the results, with the unit
  const char* title;   ///< heading in a table
};

inline constexpr std::array<SweepMeasure, 16> kSweepMeasures = {
    {{"joint1_rms_error_deg", "rms1 deg"},
     {"joint2_rms_error_deg", "rms2 deg"},
     {"joint1_final_error_deg", "final1 deg"},
     {"joint2_final_error_deg", "final2 deg"},
     {"tip_settling_time_s", "settling s"},
     {"tip_residual_rms_mm", "residual mm"},
     {"peak_torque1_nm", "peak1 Nm"},
     {"peak_torque2_nm", "peak2 Nm"},
     {"torque1_rms_nm", "effort1 Nm"},
     {"torque2_rms_nm", "effort2 Nm"},
     {"tip_motion_rms_mm", "motion mm"},
     {"tip_target_error_mm", "off target mm"},
     {"first_at_rest_over_bound", "first/bound"},
     {"later_at_rest_over_bound", "later/bound"},
     {"first_on_target_over_bound", "first on target/bound"},
     {"later_on_target_over_bound", "later on target/bound"}}};
inline constexpr std::size_t kRms1 = 0;
inline constexpr std::size_t kRms2 = 1;
inline constexpr std::size_t kSettling =
    4;  ///< NaN in a completed run means: a rest is not settled
inline constexpr std::size_t kResidual = 5;
inline constexpr std::size_t kMotion = 10;
inline constexpr std::size_t kTargetError = 11;
/// BoundRatios, of moves `duration = "shortest"` alone. NaN in a completed run: one of them never
/// came to rest, or not on its target.
inline constexpr std::size_t kFirstAtRest = 12;
inline constexpr std::size_t kLaterAtRest = 13;
inline constexpr std::size_t kFirstOnTarget = 14;
inline constexpr std::size_t kLaterOnTarget = 15;

/// One run of a sweep.
struct SweepRow {
  std::size_t point = 0;  ///< of the grid, from 0
  bool completed = false;
  std::string trip;  ///< name of the cause; empty: none
  std::string
      refused;  ///< why the run was not made: the design failed, the experiment exceeds limits
  std::int64_t ticks = 0;
  std::array<double, kSweepMeasures.size()> measure{};  ///< NaN: none
  double wall_s = 0.0;                                  ///< wall time of the run, design included
};

/// The row of a run; the caller sets its wall time.
SweepRow RowOf(std::size_t point, const SimulationRequest& request, const SimulationResult& result);
SweepRow RefusedRow(std::size_t point, const std::string& why);

/// True if two rows are equal in all but their wall time.
bool SameOutcome(const SweepRow& a, const SweepRow& b);

}  // namespace flexarm
