#pragma once

#include <Eigen/Core>
#include <array>

#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// What the model shows of the tip's acceleration at the end of a sample, and its slopes.
struct TipOutput {
  double m_s2;  ///< along the normal of link 2 at its tip: model/rigid_joint/tip_acceleration.h
  Eigen::Matrix<double, 2 * RigidJointArm::kDof, 1> by_motion;  ///< of q, q'
  double by_payload;                                            ///< m/s^2 a kg
  std::array<double, 2> by_friction;  ///< m/s^2 an N m, of hub 1 and hub 2
  std::array<double, 2> by_torque;    ///< the same
};

/// The acceleration that an accelerometer with a lag shows of the model's motion.
///
/// The equation of motion gives it from state, payload, friction and torque, `lag_s` before the
/// instant: at a corner of 100 Hz and more the sensor's filter is a delay for all that the model
/// knows, so it needs no state. The torque is taken as having held for that long. Slopes by forward
/// differences; turning th1 turns the whole arm and changes nothing.
/// Real-time: safe.
/// @param at              the instant of the reading
/// @param inputs          torque of the last piece of the sample
/// @param friction_probe  differences for the slopes by friction, > 0
TipOutput TipOutputAt(const RigidJointStepper& stepper, double lag_s, const GaugedState& at,
                      const SampleInputs& inputs,
                      const std::array<double, 2>& friction_probe_nm) noexcept;

}  // namespace flexarm
