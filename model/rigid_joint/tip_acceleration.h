#pragma once

#include <Eigen/Core>

#include "model/arm/arm_model.h"

namespace flexarm {

/// A quantity with its first two time derivatives.
struct Moving {
  double x, dot, ddot;
};

/// What moves the tip of the arm; SI, as ArmModel's coordinates.
struct TipMotion {
  Moving theta1, theta2;    ///< hubs
  Moving length1, length2;  ///< L_i, less what a bent link lacks in length
  Moving w1, w2;            ///< deflections of the links' tips
  Moving slope1;            ///< w1'(L1)
  double slope2;            ///< w2'(L2)
};

/// Acceleration of the tip along the normal of link 2 there, m/s^2: what a single-axis
/// accelerometer shows that is glued to the end of link 2.
///
/// The normal lies in the plane of the arm at gamma + alpha2 + 90 deg, so it turns with the tip;
/// positive counter-clockwise, the way w2 grows. Gravity stands on the plane and does not show.
/// Point (x, y) of a frame at the angle g: (x'' - g'' y - 2 g' y' - g'^2 x,
///                                          y'' + g'' x + 2 g' x' - g'^2 y),
/// once for the elbow in frame 1, once for the tip in frame 2.
/// Real-time: safe, |theta2| < PortableMath::kMaxAngle_rad.
double TipAcceleration(const TipMotion& motion) noexcept;

/// The same of the arm with any number of modes. @param q, v, a  of size dof()
/// Real-time: safe for as many modes as ArmSimulator steps.
double TipAcceleration(const ArmModel& arm, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v,
                       const Eigen::Ref<const Eigen::VectorXd>& a) noexcept;

}  // namespace flexarm
