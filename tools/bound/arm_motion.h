#pragma once

#include <Eigen/Core>

namespace flexarm {

/// Torques of both hubs, held for equal periods.
struct TorquePlan {
  double period_s;
  Eigen::Matrix2Xd torque_nm;  ///< a column a period

  Eigen::Index periods() const { return torque_nm.cols(); }
  double duration_s() const { return period_s * static_cast<double>(periods()); }
};

/// An arm that is to move from rest to rest, and what its motion must keep.
class ArmMotion {
 public:
  /// Small changes of the state after a period.
  struct Slopes {
    Eigen::MatrixXd by_state;
    Eigen::MatrixX2d by_torque;  ///< per N m
    Eigen::VectorXd by_period;   ///< per s
  };

  virtual ~ArmMotion() = default;

  /// The state after one period of constant torque.
  virtual Eigen::VectorXd Next(const Eigen::VectorXd& x, const Eigen::Vector2d& torque_nm,
                               double period_s) const = 0;
  /// By forward differences. MotionTransitionOver's linearisation about the middle of a period is
  /// too coarse here: 30 % off where a link bends fast.
  /// @param next  Next(x, torque_nm, period_s)
  Slopes SlopesAt(const Eigen::VectorXd& x, const Eigen::VectorXd& next,
                  const Eigen::Vector2d& torque_nm, double period_s) const;

  virtual const Eigen::VectorXd& start() const = 0;
  virtual const Eigen::VectorXd& goal() const = 0;
  /// Deviation from the goal that counts as much as a limit, for each state.
  virtual const Eigen::VectorXd& goal_scale() const = 0;
  /// The limited quantities of a state as shares of their limits: shares x is to be within +-1.
  virtual const Eigen::MatrixXd& shares() const = 0;
  virtual const Eigen::Vector2d& torque_limit_nm() const = 0;
};

/// The states of a plan, one more than its periods, a column each.
Eigen::MatrixXd StatesOf(const ArmMotion& arm, const TorquePlan& plan);

}  // namespace flexarm
