#include "controller/tasks/planned_experiment.h"

#include <algorithm>
#include <cmath>

#include "controller/types/rejected_error.h"

namespace flexarm {

PlannedExperiment::PlannedExperiment(const Experiment& experiment, const Design& design,
                                     double period_s, const std::array<double, 2>& start_rad,
                                     const MotionLimits& limits, const std::stop_token& stop)
    : reference(experiment, design, period_s, start_rad, limits, stop),
      accepted(WithChosenDurations(experiment, reference.moves(), period_s)),
      sim_events(experiment.sim_event) {
  std::stable_sort(sim_events.begin(), sim_events.end(),
                   [](const SimEvent& a, const SimEvent& b) { return a.at_s < b.at_s; });
  for (const LoadChange& change : experiment.load_change) {
    load_change.push_back(static_cast<int>(std::lround(change.at_s / period_s)));
  }
}

void RefuseSimEvents(const Experiment& experiment) {
  if (experiment.sim_event.empty()) return;
  throw RejectedError(
      "sim_event[0]: a hardware rig has no simulated switches, threads and payload; remove the "
      "[[sim_event]] rows, or use the simulated backend");
}

PlannedExperiment::PlannedExperiment(const std::vector<std::array<double, 2>>& torque_nm)
    : reference(torque_nm), mode(LoopMode::kOpenLoop) {}

PlannedExperiment::PlannedExperiment(const HomingPlan& plan)
    : reference(std::vector<std::array<double, 2>>(1)), mode(LoopMode::kRegulate), homing(plan) {}

}  // namespace flexarm
