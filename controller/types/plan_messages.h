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

// Messages between control task and planner. Samples are those of the experiment: the torque of
// sample s acts from s Ts after its start.

namespace flexarm {

/// Control task -> planner: request to plan the rest of a move.
struct PlanRequest {
  /// The longest lead time, the longest plan, one point before them and two after.
  static constexpr std::size_t kMostPoints = kMostReadyPeriods + HorizonPlan::kMaxStages + 3;

  std::uint32_t number;      ///< ascending; 0: none yet
  std::uint32_t run;         ///< Permit::run_number
  std::uint32_t valid_from;  ///< plans of earlier requests are void: another payload
  int segment;               ///< first sample of the motion: plans of another one are no warm start
  int sample;                ///< to which `x` belongs
  int first;                 ///< first sample of the plan
  int end;                   ///< of the motion: the path is at rest from then on
  std::int64_t needed_ns;    ///< due instant of the step that uses the plan's first sample
  std::array<double, 12> x;  ///< predicted for `sample`, [q; q'] of RigidJointArm
  PayloadKnowledge known;
  std::uint32_t points;                      ///< number of points in `path`
  std::array<RigidPoint, kMostPoints> path;  ///< from `sample` - 1 on, to 2 beyond the plan's last
};

/// Planner -> control task. Valid from PlanRequest::needed_ns on.
struct MotionPlan {
  std::uint32_t run;
  std::uint32_t number;  ///< of the request it answers
  HorizonPlan plan;      ///< by samples; empty: the law uses its closed form
};

using PlanRequestChannel = LatestValue<PlanRequest>;
/// Two entries, since the newest plan is published before it is valid.
using MotionPlanHistory = History<MotionPlan, 2>;
using MotionPlanChannel = LatestValue<MotionPlanHistory>;

}  // namespace flexarm
