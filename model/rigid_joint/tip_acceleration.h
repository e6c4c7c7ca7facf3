#pragma once

#include <Eigen/Core>

#include "model/arm/arm_model.h"

namespace flexarm {

/// A quantity with its first two time derivatives.
struct Moving {
  double x, dot, ddot;
};

/// Motions that determine the acceleration of the tip; SI, as ArmModel's coordinates.
struct TipMotion {
  Moving theta1, theta2;    ///< hubs
  Moving length1, length2;  ///< L_i, minus the foreshortening
  Moving w1, w2;            ///< deflections of the links' tips
  Moving slope1;            ///< w1'(L1)
  double slope2;            ///< w2'(L2)
};

/// Acceleration of the tip along the normal of link 2 there, m/s^2: the reading of a single-axis
/// accelerometer at the end of link 2.
///
/// The normal lies in the plane of the arm at gamma + alpha2 + 90 deg, so it turns with the tip;
/// positive counter-clockwise, in the direction of w2. Gravity is normal to the plane and not read.
/// Point (x, y) of a frame at the angle g: (x'' - g'' y - 2 g' y' - g'^2 x,
///                                          y'' + g'' x + 2 g' x' - g'^2 y),
/// once for the elbow in frame 1, once for the tip in frame 2.
/// Real-time: safe, |theta2| < PortableMath::kMaxAngle_rad.
double TipAcceleration(const TipMotion& motion) noexcept;

/// The same for an arm with any number of modes. @param q, v, a  of size dof()
/// Real-time: safe up to the number of modes that ArmSimulator supports.
double TipAcceleration(const ArmModel& arm, const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& v,
                       const Eigen::Ref<const Eigen::VectorXd>& a) noexcept;

}  // namespace flexarm
