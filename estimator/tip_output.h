#pragma once

#include <Eigen/Core>
#include <array>

#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// Predicted acceleration of the tip at the end of a sample, and its derivatives.
struct TipOutput {
  double m_s2;  ///< along the normal of link 2 at its tip: model/rigid_joint/tip_acceleration.h
  Eigen::Matrix<double, 2 * RigidJointArm::kDof, 1> by_motion;  ///< of q, q'
  double by_payload;                                            ///< m/s^2 per kg
  std::array<double, 2> by_friction;  ///< m/s^2 per N m, of hub 1 and hub 2
  std::array<double, 2> by_torque;    ///< the same
};

/// Measurement equation of the accelerometer at the tip, with its lag, for the EKF.
///
/// The equation of motion gives the acceleration from state, payload, friction and torque, `lag_s`
/// before the instant: at a corner of 100 Hz and more the sensor's filter is a pure delay for all
/// modes of the model, so it needs no state. The torque is assumed constant for that long.
/// Derivatives by forward differences; th1 rotates the whole arm and has no effect.
/// Real-time: safe.
/// @param at              the instant of the reading
/// @param inputs          torque of the last piece of the sample
/// @param friction_probe  differences for the derivatives by friction, > 0
TipOutput TipOutputAt(const RigidJointStepper& stepper, double lag_s, const GaugedState& at,
                      const SampleInputs& inputs,
                      const std::array<double, 2>& friction_probe_nm) noexcept;

}  // namespace flexarm
