#pragma once

#include <Eigen/Core>
#include <array>

#include "controller/planner/plan_cost.h"
#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// Affine policy for improving a trajectory: u = u_track + a step + K (x - x_track). Large.
struct PlanPolicy {
  std::array<Eigen::Vector2d, HorizonPlan::kMaxStages> step_nm;
  std::array<Eigen::Matrix<double, 2, 12>, HorizonPlan::kMaxStages> K;
};

/// Backward pass of iterative LQR, a Riccati recursion along a trajectory (Gauss-Newton): the model
/// is linearised at every sample by TransitionOver, without gauges; the cost is quadratic.
///
/// R > 0 and Q >= 0 make the Hessian of every step positive definite: no regularisation.
/// Source: docs/theory/payload.md 5.2. Real-time: safe.
/// @param track  a motion of the model, targets.stages() long
void BackwardPass(const RigidJointStepper& stepper, double payload_kg, const PlanCost& targets,
                  const PlanTrajectory& track, PlanPolicy* policy) noexcept;

}  // namespace flexarm
