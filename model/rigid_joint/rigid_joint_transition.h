#pragma once

#include <Eigen/Core>

#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// Small changes over one sample: dx(k+1) = Phi dx(k) + G dF, x = [q; q'; phi_f], F generalised
/// forces held during the sample, N m for the hubs and N for the modal coordinates.
struct Transition {
  static constexpr int kStates = 16;
  Eigen::Matrix<double, kStates, 12> by_motion;  ///< columns of q and q' of Phi
  double gauge_kept;                             ///< phi_f by itself; by nothing else
  Eigen::Matrix<double, kStates, RigidJointArm::kDof> G;
};

/// The same of x = [q; q'] and the two hub torques.
struct MotionTransition {
  Eigen::Matrix<double, 12, 12> Phi;
  Eigen::Matrix<double, 12, 2> G;
};

/// Linearises a sample of RigidJointStepper about its middle.
///
/// One midpoint step of M a + (D + dg/dv) v + (K + dg/dq) q = F with g = M(q) a + bias(q, v), then
/// doublings to the whole sample. dg by forward differences of 1e-6, 11 evaluations: th1 rotates
/// the whole arm and changes nothing. Friction is a constant force here.
/// Source: docs/theory/payload.md 2.2. Real-time: safe.
/// @param q, v  at the middle of the sample
/// @param a     mean acceleration of the sample
Transition TransitionOver(const RigidJointStepper& stepper, double payload_kg,
                          const RigidJointArm::Vector& q, const RigidJointArm::Vector& v,
                          const RigidJointArm::Vector& a) noexcept;

/// TransitionOver for the motion without the gauges' filters. Real-time: safe.
MotionTransition MotionTransitionOver(const RigidJointStepper& stepper, double payload_kg,
                                      const RigidJointArm::Vector& q,
                                      const RigidJointArm::Vector& v,
                                      const RigidJointArm::Vector& a) noexcept;

}  // namespace flexarm
