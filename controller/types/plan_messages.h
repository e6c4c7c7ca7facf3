#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "controller/exchange/history.h"
#include "controller/exchange/latest_value.h"
#include "controller/types/controller_config.h"
#include "controller/types/horizon_plan.h"
#include "estimator/payload_knowledge.h"
#include "model/rigid_joint/rigid_point.h"

// What the control task and the planner tell each other. Samples are those of the experiment: the
// torque of sample s acts from s Ts after its start on.

namespace flexarm {

/// Control task -> planner: the rest of a move is to be planned.
struct PlanRequest {
  /// Of the longest wait for a plan, of the longest plan, one before them and two beyond.
  static constexpr std::size_t kMostPoints = kMostReadyPeriods + HorizonPlan::kMaxStages + 3;

  std::uint32_t number;      ///< ascending; 0: none yet
  std::uint32_t run;         ///< LoadedExperiment::number
  std::uint32_t valid_from;  ///< plans of requests before this one are void: of another load
  int segment;               ///< first sample of the motion: plans of another one are no start
  int sample;                ///< of `x`
  int first;                 ///< sample from which the plan is to hold
  int end;                   ///< of the motion: the path rests from then on
  std::int64_t needed_ns;    ///< when the step that takes the plan's first sample is due
  std::array<double, 12> x;  ///< predicted for `sample`, [q; q'] of RigidJointArm
  PayloadKnowledge known;
  std::uint32_t points;                      ///< of `path`
  std::array<RigidPoint, kMostPoints> path;  ///< from `sample` - 1 on, to 2 beyond the plan's last
};

/// Planner -> control task. Holds from PlanRequest::needed_ns on.
struct MotionPlan {
  std::uint32_t run;
  std::uint32_t number;  ///< of the request it answers
  HorizonPlan plan;      ///< by samples; empty: the closed form is to take over
};

using PlanRequestChannel = LatestValue<PlanRequest>;
/// With the plan before it: the newest is there before it holds.
using MotionPlanHistory = History<MotionPlan, 2>;
using MotionPlanChannel = LatestValue<MotionPlanHistory>;

}  // namespace flexarm
