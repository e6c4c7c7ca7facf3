#pragma once

#include <Eigen/Core>

#include "controller/law/adaptation_matrices.h"
#include "controller/types/controller_config.h"

namespace flexarm {

/// Sobel's integral gain K_I, 2 x (n + 4) on r = [y_e; x_m; u_m], with leakage, dead zone and
/// projection.
///
///   K_I <- K_I0 + (1 - sigma) (K_I - K_I0) + v (T r)',   T = adaptation_gain I
///
/// The leakage sigma removes this share of K_I - K_I0 each sample. The dead zone omits v (T r)'
/// while |y_e| is below it: an error of the size of an encoder count is quantisation. The
/// projection scales K_I - K_I0 back to the radius `adaptation_bound` (Frobenius). Leakage and
/// projection never raise the gains' part of the Lyapunov function (7.11).
/// Source: docs/theory/control-law.md 6.5. Real-time: all but the constructor is safe.
class AdaptiveGain {
 public:
  using Gain = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, 20>;
  using Regressor = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 20, 1>;

  AdaptiveGain(const Eigen::MatrixXd& initial, const ControllerConfig& config);
  /// With T and S of `matrices` in place of adaptation_gain I and I.
  AdaptiveGain(const AdaptationMatrices& matrices, const ControllerConfig& config);

  void Reset() noexcept { K_I_ = K_I0_; }

  /// K_I r
  Eigen::Vector2d Torque(const Regressor& r) const noexcept { return K_I_.lazyProduct(r); }

  /// One sample of adaptation.
  /// @param v  of (7.14e)
  void Update(const Eigen::Vector2d& v, const Regressor& r) noexcept;

  double change() const noexcept { return (K_I_ - K_I0_).norm(); }  ///< |K_I - K_I0|, Frobenius

  /// tr(S (K_I - Kbar) T^-1 (K_I - Kbar)' S'): the gains' part of (7.11). Without matrices S = I
  /// and Kbar = K_I0, the ideal gains of the nominal plant.
  double energy() const noexcept;

 private:
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 20, 20>;

  double rate_, leak_, dead_zone_nm_, bound_;
  Gain K_I0_, K_I_;
  bool has_matrices_ = false;
  Square T_, T_inverse_;
  Eigen::Matrix2d S_ = Eigen::Matrix2d::Identity();
  Gain Kbar_;
};

}  // namespace flexarm
