#include "controller/tasks/planned_experiment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/reference/motion_change.h"
#include "controller/reference/slowed_experiment.h"
#include "controller/types/rejected_error.h"

namespace flexarm {

PlannedExperiment::PlannedExperiment(const Experiment& experiment, const Design& design,
                                     double period_s, const std::array<double, 2>& start_rad,
                                     const MotionLimits& limits, const std::stop_token& stop)
    : reference(experiment, design, period_s, start_rad, limits, stop),
      accepted(WithChosenDurations(experiment, reference.moves(), period_s)) {
  if (experiment.speed < 1.0) Slow(experiment.speed, design, period_s, start_rad, limits, stop);
  sim_events = accepted.sim_event;
  std::stable_sort(sim_events.begin(), sim_events.end(),
                   [](const SimEvent& a, const SimEvent& b) { return a.at_s < b.at_s; });
  for (const LoadChange& change : accepted.load_change) {
    load_change.push_back(static_cast<int>(std::lround(change.at_s / period_s)));
  }
}

// A law that follows a path can be made faster again; the others get slower rows.
void PlannedExperiment::Slow(double speed, const Design& design, double period_s,
                             const std::array<double, 2>& start_rad, const MotionLimits& limits,
                             const std::stop_token& stop) {
  accepted = Slowed(accepted, speed, period_s);
  if (design.scheduled) {
    reference = AtSpeed(reference, speed, design, limits);
    accepted.duration_s = reference.periods() * period_s;
    keeps_own_time = true;
  } else {
    reference = ReferenceTable(accepted, design, period_s, start_rad, limits, stop);
  }
}

PlannedExperiment::PlannedExperiment(const PlannedExperiment& before, ReferenceTable changed,
                                     int first)
    : reference(std::move(changed)),
      accepted(before.accepted),
      sim_events(before.sim_events),
      mode(before.mode),
      changes_at(first),
      keeps_own_time(true) {}

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
