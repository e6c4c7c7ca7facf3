#include "controller/law/adaptive_gain.h"

#include <Eigen/LU>

namespace flexarm {

AdaptiveGain::AdaptiveGain(const Eigen::MatrixXd& initial, const ControllerConfig& config)
    : rate_(config.adaptation_gain),
      leak_(config.sigma),
      dead_zone_nm_(config.adaptation_dead_zone_nm),
      bound_(config.adaptation_bound),
      K_I0_(initial),
      K_I_(initial),
      Kbar_(initial) {}

AdaptiveGain::AdaptiveGain(const AdaptationMatrices& matrices, const ControllerConfig& config)
    : AdaptiveGain(matrices.K_I0, config) {
  has_matrices_ = true;
  T_ = matrices.T;
  T_inverse_ = matrices.T.inverse();  // start-up
  S_ = matrices.S;
  Kbar_ = matrices.Kbar;
}

void AdaptiveGain::Update(const Eigen::Vector2d& v, const Regressor& r) noexcept {
  K_I_ -= leak_ * (K_I_ - K_I0_);
  if (r.head<2>().norm() < dead_zone_nm_) return;
  if (has_matrices_) {
    const Regressor Tr = T_.lazyProduct(r);
    K_I_ += v.lazyProduct(Tr.transpose());
  } else {
    K_I_ += (rate_ * v).lazyProduct(r.transpose());
  }
  const double distance = change();
  if (distance > bound_) K_I_ = K_I0_ + (bound_ / distance) * (K_I_ - K_I0_);
}

double AdaptiveGain::energy() const noexcept {
  if (has_matrices_) {
    const Gain change = S_.lazyProduct(K_I_ - Kbar_);
    const Gain scaled = change.lazyProduct(T_inverse_);
    return scaled.cwiseProduct(change).sum();
  }
  return rate_ > 0.0 ? (K_I_ - K_I0_).squaredNorm() / rate_ : 0.0;
}

}  // namespace flexarm
