#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "controller/law/adaptive_gain.h"
#include "controller/law/design.h"
#include "controller/law/law.h"
#include "controller/law/settle_term.h"
#include "controller/types/controller_config.h"
#include "controller/types/step_types.h"
#include "estimator/state_estimate.h"

namespace flexarm {

/// Feedback torque of the law per deviation from the reference, 2 x n, N m per SI unit: C_p, for an
/// adaptive law K_e C_p.
Eigen::MatrixXd FeedbackGain(const Design& design, const ControllerConfig& config);

/// Every law that follows the reference model: feedforward plus feedback; Sobel's law adapts.
///
///   u = u* + C_p (x_m - x), clipped to the torque limits
///
/// | name           | u*                                              | C_p                     |
/// |----------------|-------------------------------------------------|-------------------------|
/// | sobel-thesis   | vartheta u_f + (1 - vartheta) u_c (7.24)        | LQR with alpha          |
/// | sobel          | the same, plus SettleTerm at rest               | LQR with alpha          |
/// | sobel-original | u_c                                             | LQR with alpha = 0      |
/// | lqr-cgt        | u_c = S21 x_m + S22 u_m                         | LQR with alpha          |
/// | lqr-um         | u_m                                             | LQR with alpha          |
/// | lqg            | 0, of x_m only the joints' angles and rates     | LQR with alpha = 0      |
/// | pd, pd-zv(d)   | u_m                                             | stiffness, damping a hub |
///
/// u_f is (7.25). The adaptive laws (thesis 7.2 to 7.4, docs/theory/control-law.md 6) give instead
///
///   x* = S11 x_m + S12 u_m,  e = x* - x,  y_e = C_p (x_m - x) = C_p e
///   r  = [y_e; x_m; u_m],  rho = r' Tbar r
///   v  = (I + rho G)^-1 (F e + G (u* + K_e C_p e - K_I r)),  F = (S'S)^-1 C_p
///   u  = K_I r + rho v, clipped
///   K_I <- (1 - sigma) (K_I - K_I0) + K_I0 + v (T r)'
///
/// T, Tbar, S, K_e and K_I(0) are those of [controller.matrices] (adaptation_matrices.h). The
/// algebraic loop between v and u is solved within the sample. With T = Tbar = 0 the law is
/// lqr-cgt.
/// Real-time: Reset and Compute are safe.
class TrackingLaw final : public Law {
 public:
  TrackingLaw(const Design& design, const ControllerConfig& config,
              const std::array<double, 2>& torque_limit_nm, std::optional<SettleTerm> settle = {});

  /// Resets K_I to [I, S21, S22]: the law starts as lqr-cgt, without a step in its torque.
  void Reset() noexcept override {
    K_I_.Reset();
    if (settle_) settle_->Reset();
  }

  /// @param x          plant state at the instant at which the torque acts
  /// @param reference  of the same instant
  /// @param may_adapt  false: K_I is held (invalid sensor, not Running)
  ///
  /// The result has V = e'Pe + tr((K_I - K_I0) T^-1 (K_I - K_I0)'), N m squared. On the nominal
  /// plant V decreases from sample to sample (vartheta = 0, u_m constant). NaN with another K_e,
  /// and for the laws whose trajectory is not the command generator's: lqr-um, lqg, pd.
  /// @param payload, settling_share  used by SettleTerm only
  LawOutput Compute(const StateVector& x, const ReferenceSample& reference, bool may_adapt,
                    const PayloadKnowledge& payload = kNoPayloadEstimate,
                    double settling_share = 0.0) noexcept;
  LawOutput Compute(const LawInput& input) noexcept override {
    return Compute(*input.x, *input.reference, input.may_adapt, input.payload,
                   input.settling_share);
  }

  /// Frobenius norm of K_I - K_I(0).
  double adaptive_gain_change() const noexcept override { return K_I_.change(); }

 private:
  using Matrix2n = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, 16>;
  using MatrixNn = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 16, 16>;
  using MatrixN2 = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, 16, 2>;

  void SetFeedforward(const Design& design);
  /// Replaces the defaults by the matrices of the config.
  void SetMatrices(const Design& design);
  Eigen::Vector2d Feedforward(const StateVector& x_m, const Eigen::Vector2d& u_m) const noexcept;
  double Lyapunov(const StateVector& x, const StateVector& x_m,
                  const Eigen::Vector2d& u_m) const noexcept;

  ControllerConfig config_;
  std::array<double, 2> torque_limit_nm_;
  Eigen::Index states_;
  Matrix2n Cp_;
  Eigen::Matrix2d G_;
  Matrix2n feedforward_x_;  // u* = feedforward_x x_m + feedforward_u u_m
  Eigen::Matrix2d feedforward_u_;
  MatrixNn P_, S11_;
  MatrixN2 S12_;
  AdaptiveGain K_I_;
  bool has_matrices_ = false;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 20, 20> Tbar_;
  Eigen::Matrix2d K_e_ = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d StS_inverse_ = Eigen::Matrix2d::Identity();
  std::optional<SettleTerm> settle_;
};

}  // namespace flexarm
