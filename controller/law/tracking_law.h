#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "controller/law/controller_config.h"
#include "controller/law/design.h"
#include "controller/law/step_types.h"
#include "estimator/state_estimator.h"

namespace flexarm {

/// C_p of the law, 2 x n: the torque a deviation from the reference is answered with, N m per SI
/// unit.
Eigen::MatrixXd FeedbackGain(const Design& design, const ControllerConfig& config);

/// Every law that follows the reference model: a feedforward and a feedback, and Sobel's adapts.
///
///   u = u* + C_p (x_m - x), clipped to the torque limits
///
/// | name           | u*                                              | C_p                       |
/// |----------------|-------------------------------------------------|---------------------------|
/// | sobel          | vartheta u_f + (1 - vartheta) u_c (7.24)         | LQR with alpha | |
/// sobel-original | u_c                                             | LQR with alpha = 0        |
/// | lqr-cgt        | u_c = S21 x_m + S22 u_m                         | LQR with alpha            |
/// | lqr-um         | u_m                                             | LQR with alpha            |
/// | lqg            | 0, of x_m only the hubs' angles and rates       | LQR with alpha = 0        |
/// | pd, pd-zv(d)   | u_m                                             | stiffness, damping a hub  |
///
/// u_f is (7.25). The adaptive laws (thesis 7.2 to 7.4, control.md section 4) give instead
///
///   x* = S11 x_m + S12 u_m,  e = x* - x,  y_e = C_p (x_m - x) = C_p e
///   r  = [y_e; x_m; u_m],  rho = r' Tbar r
///   v  = (I + rho G)^-1 (F e + G (u* + K_e C_p e - K_I r)),  F = C_p, K_e = I
///   u  = K_I r + rho v, clipped
///   K_I <- (1 - sigma) (K_I - K_I0) + K_I0 + v (T r)'
///
/// The algebraic loop between v and u is solved, not delayed. With T = Tbar = 0 it is lqr-cgt.
/// Real-time: Reset and Compute are safe.
class TrackingLaw {
 public:
  struct Result {
    std::array<double, 2> torque_nm;
    std::uint32_t limits;  ///< LimitBit
    bool finite;           ///< false: the law computed no number; the torque is zero
  };

  TrackingLaw(const Design& design, const ControllerConfig& config,
              const std::array<double, 2>& torque_limit_nm);

  /// K_I back to [I, S21, S22].
  void Reset() noexcept;

  /// @param x          plant state at the instant the torque acts
  /// @param reference  of the same instant
  /// @param may_adapt  false holds K_I (invalid sensor, not Running)
  Result Compute(const StateVector& x, const ReferenceSample& reference, bool may_adapt) noexcept;

  /// Calm regulator towards `x_goal`: u = K_stop (x_goal - x), clipped. Damps the arm while
  /// Stopping.
  Result Regulate(const StateVector& x, const StateVector& x_goal) const noexcept;

  /// A torque that no law computed, clipped.
  Result Clip(const Eigen::Vector2d& u) const noexcept;

  double adaptive_gain_change() const noexcept;  ///< Frobenius norm of K_I - K_I(0)

 private:
  using Matrix2n = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, 16>;
  using Regressor = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 20, 1>;
  using AdaptiveGain = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, 20>;

  void SetFeedforward(const Design& design);
  Eigen::Vector2d Feedforward(const StateVector& x_m, const Eigen::Vector2d& u_m) const noexcept;

  ControllerConfig config_;
  std::array<double, 2> torque_limit_nm_;
  Eigen::Index states_;
  Matrix2n Cp_;
  Matrix2n K_stop_;
  Eigen::Matrix2d G_;
  Matrix2n feedforward_x_;  // u* = feedforward_x x_m + feedforward_u u_m
  Eigen::Matrix2d feedforward_u_;
  AdaptiveGain K_I0_, K_I_;
};

}  // namespace flexarm
