#pragma once

#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// How far the tip swings: the amplitude, in the slowest vibration of the straight arm with locked
/// hubs, that has the energy of the arm's bending and motion.
/// Source: docs/theory/control-law.md 14.3. Real-time: all but the constructor is safe.
class TipSway {
 public:
  TipSway(const RigidJointArm& arm, double payload_kg);

  /// @param q, v  as in RigidJointArm  @returns m, at least 0
  double Amplitude_m(const RigidJointArm::Vector& q, const RigidJointArm::Vector& v) const noexcept;

 private:
  RigidJointArm::Matrix mass_, stiffness_;
  double stiffness_n_per_m_;  // of that vibration, at the tip
};

}  // namespace flexarm
