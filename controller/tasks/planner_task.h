#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "controller/law/design.h"
#include "controller/law/scheduled_law.h"
#include "controller/planner/horizon_planner.h"
#include "controller/realtime/task.h"
#include "controller/tasks/plan_follower.h"
#include "controller/types/loop_grid.h"
#include "controller/types/plan_messages.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// The schedule of plan requests by [controller.plan].
PlanSchedule PlanScheduleOf(const RigConfig& config);

/// The settings of the planner by [controller.plan], [controller.payload] and the torque limits.
HorizonPlannerConfig PlannerConfigOf(const RigConfig& config);

/// The planner task: on request of the control task it plans the rest of a move, for the payload
/// estimate of the request and from the state predicted for the instant at which the plan becomes
/// valid.
///
/// The time for a plan is PlanSchedule::ready periods; the control task never waits. If
/// HorizonPlanner refuses a plan, the previous one stays valid, unless it is for another payload
/// (HorizonPlanner::IsFor): then the law uses its closed form.
/// Source: docs/theory/payload.md 5.4. Real-time: safe after construction; no lock, no allocation,
/// and every loop has a bound. Large: 2 MB.
class PlannerTask final : public Task {
 public:
  /// Below 50, at which the kernel runs the threads of interrupts: a plan takes milliseconds, which
  /// the answers of a bus cannot wait.
  static constexpr int kPriority = 45;

  /// @param config  with [controller.payload] and [controller.plan]
  /// @param design  with `scheduled` and its start_gains
  PlannerTask(const RigConfig& config, const Design& design);

  PlanRequestChannel& requests() noexcept { return requests_; }  ///< written by the control task
  MotionPlanChannel& plans() noexcept { return plans_; }         ///< read by it

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  const HorizonPlanner::Figures& figures() const noexcept { return planner_.figures(); }

 private:
  /// Prediction for the instant at which the plan becomes valid.
  struct Start {
    PlanState x;
    Eigen::Vector2d torque_before_nm;
  };

  Start Predict(const PlanRequest& request, int periods) const noexcept;
  void Publish(std::int64_t holds_from_ns) noexcept;

  LoopGrid grid_;
  PlanSchedule schedule_;
  ScheduledLaw law_;
  RigidJointStepper stepper_;
  HorizonPlannerConfig config_;
  Eigen::Vector2d torque_limit_nm_;
  HorizonPlanner planner_;
  PlanRequestChannel requests_{PlanRequest{}};
  MotionPlanChannel plans_{MotionPlanHistory(MotionPlan{})};
  MotionPlanHistory history_{MotionPlan{}};
  MotionPlan newest_{};  // published last
  HorizonPlan made_;
  int segment_ = -1;  // of newest_
  std::uint32_t answered_ = 0;
};

}  // namespace flexarm
