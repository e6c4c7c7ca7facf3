#include "controller/tasks/planner_task.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "controller/reference/path_reference.h"

namespace flexarm {
namespace {

constexpr double kAnyGauge_hz = 1.0;  // no effect: the prediction has no gauges

}  // namespace

HorizonPlannerConfig PlannerConfigOf(const RigConfig& config) {
  const PlanAheadConfig& plan = *config.controller.plan;
  const std::array<double, 2>& limit_nm = config.safety.torque_limit_nm;
  return {.weights = {.moving = plan.moving_weight,
                      .resting = plan.resting_weight,
                      .torque = plan.torque_weight,
                      .light_kg = plan.light_kg,
                      .reference_payload_kg = config.controller.payload->reference_kg},
          .torque_limit_nm = {plan.torque_share * limit_nm[0], plan.torque_share * limit_nm[1]},
          .roughness = plan.roughness,
          .payload_change_kg = plan.payload_change_kg,
          .payload_change_share = plan.payload_change_share};
}

PlanSchedule PlanScheduleOf(const RigConfig& config) {
  const PlanAheadConfig& plan = *config.controller.plan;
  return {.every = plan.every_periods,
          .ready = plan.ready_periods,
          .rest = plan.rest_periods,
          .period_ns = LoopGrid(config.loop).period_ns};
}

PlannerTask::PlannerTask(const RigConfig& config, const Design& design)
    : grid_(config.loop),
      schedule_(PlanScheduleOf(config)),
      law_(MakeRigidJointArm(design), design.scheduled->gains, BendingGuard(config),
           design.scheduled->max_kg, grid_.period_s(), config.safety.torque_limit_nm),
      stepper_(MakeRigidJointArm(design), grid_.period_s(), kAnyGauge_hz),
      config_(PlannerConfigOf(config)),
      torque_limit_nm_(Eigen::Vector2d::Map(config_.torque_limit_nm.data())),
      planner_(MakeRigidJointArm(design), grid_.period_s(), *design.scheduled->start_gains,
               config_) {}

// Due when the step has published, which may have made a request.
Task::Traits PlannerTask::traits() const noexcept {
  return {.name = "planner",
          .period_ns = grid_.period_ns,
          .phase_ns = grid_.phase_ns + grid_.deadline_ns,
          .deadline_ns = (schedule_.ready - 1) * grid_.period_ns,
          .priority = kPriority};
}

void PlannerTask::Run(const Activation& /*activation*/) noexcept {
  const PlanRequest& request = requests_.Read();
  if (request.number == answered_) return;
  answered_ = request.number;

  if (newest_.run != request.run || newest_.number < request.valid_from) newest_.plan.Begin(0, 0.0);

  const int periods = request.first - request.sample;
  const Start start = Predict(request, periods);
  const bool continues = newest_.run == request.run && segment_ == request.segment;
  const std::size_t points = request.points - static_cast<std::uint32_t>(periods);
  const PlanProblem problem{
      .first_tick = request.first,
      .x = start.x,
      .payload_kg = request.known.payload_kg,
      .torque_before_nm = start.torque_before_nm,
      .path = std::span(request.path).subspan(static_cast<std::size_t>(periods), points),
      .move_samples = static_cast<std::size_t>(request.end - request.first)};
  if (planner_.Plan(problem, continues ? &newest_.plan : nullptr, &made_)) {
    newest_.plan = made_;
  } else if (!continues || !planner_.IsFor(newest_.plan, problem.payload_kg)) {
    newest_.plan.Begin(request.first, problem.payload_kg);
  } else {
    return;
  }
  newest_.run = request.run;
  newest_.number = request.number;
  segment_ = request.segment;
  Publish(request.needed_ns);
}

// Without friction, as in the plan: the law's friction feedforward is assumed to cancel it.
PlannerTask::Start PlannerTask::Predict(const PlanRequest& request, int periods) const noexcept {
  PayloadKnowledge known = request.known;
  known.friction_nm = {0.0, 0.0};
  Start at{.x = PlanState::Map(request.x.data()), .torque_before_nm = {0.0, 0.0}};
  for (int i = 0; i < periods; ++i) {
    const std::array<RigidPoint, 3> path = {request.path[static_cast<std::size_t>(i)],
                                            request.path[static_cast<std::size_t>(i) + 1],
                                            request.path[static_cast<std::size_t>(i) + 2]};
    MotionSample desired = law_.ClosedForm(known.payload_kg, path);
    const auto entry = newest_.plan.At(request.sample + i);
    if (entry) desired = entry->motion;
    at.torque_before_nm = law_.Torque(at.x, known, desired, 0.0)
                              .cwiseMax(-torque_limit_nm_)
                              .cwiseMin(torque_limit_nm_);
    const GaugedState next = stepper_.Advance(
        {.q = at.x.head<6>(), .v = at.x.tail<6>(), .phi_f = Eigen::Vector4d::Zero()},
        {.torque_nm = at.torque_before_nm,
         .payload_kg = known.payload_kg,
         .friction_nm = {0.0, 0.0}});
    at.x << next.q, next.v;
  }
  return at;
}

void PlannerTask::Publish(std::int64_t holds_from_ns) noexcept {
  history_.Push(holds_from_ns, newest_);
  plans_.Publish(history_);
}

}  // namespace flexarm
