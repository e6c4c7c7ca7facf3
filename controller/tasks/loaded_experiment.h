#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "controller/exchange/latest_value.h"
#include "controller/reference/reference.h"
#include "controller/tasks/homing_reference.h"
#include "controller/types/experiment.h"

namespace flexarm {

/// An accepted experiment: made once by the operator's side, never changed after.
struct PlannedExperiment {
  /// Parameters as ReferenceTable's. @throws Refused as ReferenceTable
  PlannedExperiment(const Experiment& experiment, const Design& design, double period_s,
                    const std::array<double, 2>& start_rad, const MotionLimits& limits);

  /// Torques in open loop: the pluck test.
  explicit PlannedExperiment(const std::vector<std::array<double, 2>>& torque_nm);
  /// A search for a limit switch.
  explicit PlannedExperiment(const HomingPlan& plan);

  ReferenceTable reference;          ///< of a homing run: nothing
  Experiment accepted{};             ///< the experiment with the durations that were chosen, if any
  std::vector<SimEvent> sim_events;  ///< in order of time; simulated backend only
  LoopMode mode = LoopMode::kFollow;
  HomingPlan homing{};  ///< if mode is kRegulate
};

/// For a rig that is real.
/// @throws Refused naming the first row of what can only happen to a simulated one
void RefuseSimEvents(const Experiment& experiment);

/// The experiment that the next run follows. The operator's side keeps it alive until every reader
/// has released its number.
struct LoadedExperiment {
  const PlannedExperiment* experiment = nullptr;  ///< nullptr: none planned, a run ends where it is
  std::uint32_t number = 0;                       ///< ascending
};
using ExperimentChannel = LatestValue<LoadedExperiment>;
using CalibrationChannel = LatestValue<Calibration>;

}  // namespace flexarm
