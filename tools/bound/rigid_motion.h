#pragma once

#include "model/rigid_joint/rigid_joint_arm.h"
#include "tools/bound/arm_motion.h"
#include "tools/bound/bound_limits.h"
#include "tools/bound/rest_move.h"

namespace flexarm {

/// The arm with links that do not bend: states Y and Y' of both joints.
class RigidMotion : public ArmMotion {
 public:
  RigidMotion(const RigidJointArm& arm, const BoundLimits& limits, const RestMove& move);

  Eigen::VectorXd Next(const Eigen::VectorXd& x, const Eigen::Vector2d& torque_nm,
                       double period_s) const override;
  const Eigen::VectorXd& start() const override { return start_; }
  const Eigen::VectorXd& goal() const override { return goal_; }
  const Eigen::VectorXd& goal_scale() const override { return goal_scale_; }
  const Eigen::MatrixXd& shares() const override { return shares_; }
  const Eigen::Vector2d& torque_limit_nm() const override { return torque_limit_nm_; }

 private:
  const RigidJointArm& arm_;
  OutboardBody body_;
  Eigen::VectorXd start_, goal_, goal_scale_;
  Eigen::MatrixXd shares_;
  Eigen::Vector2d torque_limit_nm_;
};

}  // namespace flexarm
