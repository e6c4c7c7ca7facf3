#pragma once

#include <Eigen/Core>

#include "model/arm/arm_model.h"

namespace flexarm {

/// x' = A x + B u about a state, x = [q; v] deviations, u = motor torque deviations, N m.
struct LinearModel {
  Eigen::MatrixXd A;  ///< 2 dof x 2 dof
  Eigen::MatrixXd B;  ///< 2 dof x 2
};

/// Jacobians of the equations of motion at any state, equilibrium or not.
///
/// A = [[0, 1], [-M^-1 (dF/dq + K), -M^-1 (dF/dv + D)]], F = M(q) a + bias(q, v) with a the
/// acceleration at the state. dF by the complex step with h = 1e-30: no cancellation, so exact to
/// round-off. Replaces the thesis's Appendix C. Backlash of joint 2 enters by its slopes at the
/// state: no spring within the clearance. Friction (3.12) is not differentiable at zero rate; it is
/// left out, or, as in the thesis's 6.2, smoothed to K_F tanh(k th').
/// @param torque_nm              on th3 and th4 at the state, N m
/// @param friction_gain_s_per_rad  k >= 0; 0: no friction
LinearModel Linearize(const ArmModel& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                      const Eigen::Vector2d& torque_nm, double friction_gain_s_per_rad = 0.0);

/// The same along a motion with given accelerations: those of a nominal trajectory, sustained by
/// whatever forces are required. With a = 0 the nominal trajectory has constant rates.
/// @param a  nominal accelerations, dof, rad/s^2 and m/s^2
LinearModel LinearizeAlong(const ArmModel& model, const Eigen::VectorXd& q,
                           const Eigen::VectorXd& v, const Eigen::VectorXd& a);

/// Undamped natural frequencies at rest, unbent, elbow at theta2_rad, Hz, ascending. Motors free:
/// the two rigid-body zeros are left out.
Eigen::VectorXd FreeMotorFrequenciesHz(const ArmModel& model, double theta2_rad);

/// The same with both rotors (th3, th4) held.
Eigen::VectorXd HeldMotorFrequenciesHz(const ArmModel& model, double theta2_rad);

}  // namespace flexarm
