#pragma once

#include <Eigen/Core>

#include "estimator/state_estimate.h"
#include "estimator/state_layout.h"

namespace flexarm {

/// The controller of Stopping and of homing: a regulator without prescribed degree of stability,
/// u = K_stop (x_goal - x), whose goal is an arm at rest.
///
/// While Stopping the goal follows the hubs, so that the arm with a heavy payload is not pulled
/// back for long. The torque starts at that of the step before and decays to the regulator's;
/// after 1.8 s it is ramped to zero over 0.4 s. Not clipped. Source: docs/theory/control-law.md 9.
/// Real-time: all but the constructor is safe.
class StopController {
 public:
  /// @param K_stop  2 x n: Design::K_stop
  StopController(const Eigen::MatrixXd& K_stop, const StateLayout& layout, double period_s)
      : K_stop_(K_stop), layout_(layout), period_s_(period_s) {}

  /// Torque that regulates to rest with the hubs at `hub_rad`.
  Eigen::Vector2d Regulate(const StateVector& x, const Eigen::Vector2d& hub_rad) const noexcept;

  /// Start of a stop. @param hub_rad  first goal  @param torque_nm  of the step before
  void Begin(const Eigen::Vector2d& hub_rad, const Eigen::Vector2d& torque_nm) noexcept;
  /// Torque of one sample of a stop. @param x  state at the instant at which the torque acts
  Eigen::Vector2d Stop(const StateVector& x) noexcept;

 private:
  using Matrix2n = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, 16>;

  Matrix2n K_stop_;
  StateLayout layout_;
  double period_s_;
  Eigen::Vector2d goal_rad_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d torque_before_nm_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d jump_nm_ = Eigen::Vector2d::Zero();  // difference to that torque, decays
  double stopping_s_ = -1.0;                           // negative: the next sample is the first
};

}  // namespace flexarm
