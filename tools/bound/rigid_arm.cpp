#include "tools/bound/rigid_arm.h"

#include "model/math/library_math.h"

namespace flexarm {

RigidForces RigidForcesAt(const RigidJointArm& arm, const OutboardBody& body,
                          const Eigen::Vector2d& angle_rad, const Eigen::Vector2d& rate_rad_s) {
  RigidJointArm::Vector q = RigidJointArm::Vector::Zero(), v = RigidJointArm::Vector::Zero();
  q.head<2>() = angle_rad;
  v.head<2>() = rate_rad_s;
  const RigidJointArm::Inertia at = arm.At<LibraryMath>(body, q, v);
  return {.M = at.M.topLeftCorner<2, 2>(), .bias = at.bias.head<2>()};
}

}  // namespace flexarm
