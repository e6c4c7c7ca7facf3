#pragma once

#include "model/rigid_joint/rigid_joint_arm.h"
#include "tools/bound/arm_motion.h"
#include "tools/bound/bound_limits.h"
#include "tools/bound/rest_move.h"

namespace flexarm {

/// The arm of RigidJointArm, whose links bend: states q and q', without friction.
class FlexibleMotion : public ArmMotion {
 public:
  FlexibleMotion(const RigidJointArm& arm, const BoundLimits& limits, const RestMove& move);

  Eigen::VectorXd Next(const Eigen::VectorXd& x, const Eigen::Vector2d& torque_nm,
                       double period_s) const override;
  const Eigen::VectorXd& start() const override { return start_; }
  const Eigen::VectorXd& goal() const override { return goal_; }
  const Eigen::VectorXd& goal_scale() const override { return goal_scale_; }
  const Eigen::MatrixXd& shares() const override { return shares_; }
  const Eigen::Vector2d& torque_limit_nm() const override { return torque_limit_nm_; }

 private:
  const RigidJointArm& arm_;
  double payload_kg_;
  Eigen::VectorXd start_, goal_, goal_scale_;
  Eigen::MatrixXd shares_;
  Eigen::Vector2d torque_limit_nm_;
};

}  // namespace flexarm
