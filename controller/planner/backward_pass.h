#pragma once

#include <Eigen/Core>
#include <array>

#include "controller/planner/plan_cost.h"
#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// How to leave a trajectory for a cheaper one: u = u_track + a step + K (x - x_track). Large.
struct PlanPolicy {
  std::array<Eigen::Vector2d, HorizonPlan::kMaxStages> step_nm;
  std::array<Eigen::Matrix<double, 2, 12>, HorizonPlan::kMaxStages> K;
};

/// One backward Riccati sweep along a trajectory, Gauss-Newton: the model linearised at every
/// sample by TransitionOver, without its gauges; the cost as it is, a quadratic.
///
/// R > 0 and Q >= 0 make every step's Hessian positive definite: nothing is regularised.
/// Source: docs/theory/payload.md 5.2. Real-time: safe.
/// @param track  a motion of the model, targets.stages() long
void BackwardPass(const RigidJointStepper& stepper, double payload_kg, const PlanCost& targets,
                  const PlanTrack& track, PlanPolicy* policy) noexcept;

}  // namespace flexarm
