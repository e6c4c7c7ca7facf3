#pragma once

#include <Eigen/Core>
#include <array>

#include "estimator/piecewise_torque.h"
#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// What the motion of a sample starts from and depends on, besides the torque.
struct MotionStart {
  GaugedState state;
  double payload_kg;
  std::array<double, 2> friction_nm;  ///< Coulomb levels of the hubs
};

/// The state after `torque`, in steps of the stepper; ends of pieces are rounded to the nearest
/// step. Source: docs/theory/payload.md 1. Real-time: safe.
GaugedState MotionAfter(const RigidJointStepper& stepper, const MotionStart& start,
                        const PiecewiseTorque& torque) noexcept;

/// The state after a sample and its derivatives by payload (per kg), friction of hub 1 and of hub 2
/// (per N m): rows q, q', phi_f.
struct MotionWithSlopes {
  GaugedState state;
  Eigen::Matrix<double, 16, 3> by_parameter;
};

/// MotionAfter, to the bit, with derivatives by forward differences of these sizes. The four cases
/// are computed at once. Real-time: safe.
MotionWithSlopes MotionAfterWithSlopes(const RigidJointStepper& stepper, const MotionStart& start,
                                       const PiecewiseTorque& torque, double payload_probe_kg,
                                       const std::array<double, 2>& friction_probe_nm) noexcept;

/// q, q' and phi_f in one vector.
Eigen::Matrix<double, 16, 1> Stacked(const GaugedState& x) noexcept;

}  // namespace flexarm
