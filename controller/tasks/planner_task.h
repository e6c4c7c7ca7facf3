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

/// When the control task asks, and from when on plans hold.
PlanSchedule PlanScheduleOf(const RigConfig& config);

/// The planner's thread: plans the rest of a move whenever the control task asks, for the payload
/// that is known by then and from the state that the arm will have when the plan holds.
///
/// It has PlanSchedule::ready periods for it; the control task waits for nothing. A plan that is
/// refused (HorizonPlanner) leaves the one before it in force, unless that was made for quite
/// another payload: then the closed form takes over.
/// Source: docs/theory/payload.md 5.4. Real-time: safe after construction; no lock, no allocation,
/// and every loop has a bound. Large: 2 MB.
class PlannerTask final : public Task {
 public:
  static constexpr int kPriority = 50;

  /// @param config  with [controller.payload] and [controller.plan]
  /// @param design  with `scheduled` and its start_gains
  PlannerTask(const RigConfig& config, const Design& design);

  PlanRequestChannel& requests() noexcept { return requests_; }  ///< written by the control task
  MotionPlanChannel& plans() noexcept { return plans_; }         ///< read by it

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  const HorizonPlanner::Figures& figures() const noexcept { return planner_.figures(); }

 private:
  /// What the arm will do until the plan holds.
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
  MotionPlan newest_{};  // what control was told last
  HorizonPlan made_;
  int segment_ = -1;  // that the newest is of
  std::uint32_t answered_ = 0;
};

}  // namespace flexarm
