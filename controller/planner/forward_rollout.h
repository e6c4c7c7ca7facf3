#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "controller/planner/plan_cost.h"
#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// Forward rollout: the model's motion from track->x[0] under a law with limited torque, without
/// friction, which the loop's law compensates when the torque is issued.
///
/// Source: docs/theory/payload.md 5.3: the design study plans without friction.
/// Real-time: safe if the law is.
/// @param law  torque by sample and state, N m: Eigen::Vector2d(std::size_t k, const PlanState& x)
template <typename Law>
void RollOut(const RigidJointStepper& stepper, double payload_kg, std::size_t stages,
             const Eigen::Vector2d& torque_limit_nm, const Law& law,
             PlanTrajectory* track) noexcept {
  GaugedState state{
      .q = track->x[0].head<6>(), .v = track->x[0].tail<6>(), .phi_f = Eigen::Vector4d::Zero()};
  for (std::size_t k = 0; k < stages; ++k) {
    const Eigen::Vector2d asked = law(k, track->x[k]);
    track->torque_nm[k] = asked.cwiseMax(-torque_limit_nm).cwiseMin(torque_limit_nm);
    state = stepper.Advance(
        state,
        {.torque_nm = track->torque_nm[k], .payload_kg = payload_kg, .friction_nm = {0.0, 0.0}});
    track->x[k + 1] << state.q, state.v;
  }
}

}  // namespace flexarm
