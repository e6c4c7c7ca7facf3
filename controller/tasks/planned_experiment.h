#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "controller/exchange/latest_value.h"
#include "controller/reference/reference.h"
#include "controller/tasks/homing_reference.h"
#include "controller/types/experiment.h"

namespace flexarm {

/// An accepted experiment with its reference. Made once by the operator task, then constant.
struct PlannedExperiment {
  /// Parameters as ReferenceTable's. @throws RejectedError as ReferenceTable
  PlannedExperiment(const Experiment& experiment, const Design& design, double period_s,
                    const std::array<double, 2>& start_rad, const MotionLimits& limits,
                    const std::stop_token& stop = {});

  /// The same run with a path that is another from sample `first` on (motion_change.h).
  PlannedExperiment(const PlannedExperiment& before, ReferenceTable changed, int first);

  /// Torques in open loop: the pluck test.
  explicit PlannedExperiment(const std::vector<std::array<double, 2>>& torque_nm);
  /// A search for a limit switch.
  explicit PlannedExperiment(const HomingPlan& plan);

  ReferenceTable reference;          ///< empty for a homing run
  Experiment accepted{};             ///< the experiment as it runs, with the chosen durations
  std::vector<int> load_change;      ///< samples at which a change of the payload is announced
  std::vector<SimEvent> sim_events;  ///< in order of time; simulated backend only
  LoopMode mode = LoopMode::kFollow;
  HomingPlan homing{};  ///< if mode is kRegulate
  int changes_at = 0;   ///< of a changed path: its first sample that differs
  /// Its path was slowed or changed: plans ahead, which are of the planned path, do not apply.
  bool keeps_own_time = false;

 private:
  void Slow(double speed, const Design& design, double period_s,
            const std::array<double, 2>& start_rad, const MotionLimits& limits,
            const std::stop_token& stop);
};

/// Rejects [[sim_event]] rows on a hardware rig.
/// @throws RejectedError naming the first row
void RefuseSimEvents(const Experiment& experiment);

using CalibrationChannel = LatestValue<Calibration>;

}  // namespace flexarm
