#pragma once

#include <Eigen/Core>

#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// The arm of RigidJointArm with links that do not bend: M(Y) Y'' + bias(Y, Y') = u, without
/// friction.
struct RigidForces {
  Eigen::Matrix2d M;     ///< kg m^2
  Eigen::Vector2d bias;  ///< Coriolis and centrifugal, N m
};

/// @param angle_rad, rate_rad_s  Y, Y' of both joints
RigidForces RigidForcesAt(const RigidJointArm& arm, const OutboardBody& body,
                          const Eigen::Vector2d& angle_rad, const Eigen::Vector2d& rate_rad_s);

}  // namespace flexarm
