#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "controller/law/controller_config.h"
#include "controller/law/design.h"
#include "controller/law/step_types.h"
#include "estimator/state_estimator.h"

namespace flexarm {

/// The modified Sobel model-reference adaptive law (thesis 7.2 to 7.4, control.md section 4).
///
///   x* = S11 x_m + S12 u_m,  e = x* - x,  y_e = C_p (x_m - x) = C_p e
///   u* = vartheta u_f + (1 - vartheta) (S21 x_m + S22 u_m)                        (7.24), (7.25)
///   r  = [y_e; x_m; u_m],  rho = r' Tbar r
///   v  = (I + rho G)^-1 (F e + G (u* + K_e C_p e - K_I r)),  F = C_p, K_e = I
///   u  = K_I r + rho v,  clipped to the torque limits
///   K_I <- (1 - sigma) (K_I - K_I0) + K_I0 + v (T r)'
///
/// The algebraic loop between v and u is solved, not delayed. `lqr-cgt` is the same with
/// T = Tbar = 0: u = y_e + S21 x_m + S22 u_m. Without adaptation u = u* + y_e.
/// Real-time: Reset and Compute are safe.
class SobelLaw {
 public:
  struct Result {
    std::array<double, 2> torque_nm;
    std::uint32_t limits;  ///< LimitBit
    bool finite;           ///< false: the law computed no number; the torque is zero
  };

  SobelLaw(const Design& design, const ControllerConfig& config,
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
