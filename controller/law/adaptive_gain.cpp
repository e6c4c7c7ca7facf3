#include "controller/law/adaptive_gain.h"

namespace flexarm {

AdaptiveGain::AdaptiveGain(const Eigen::MatrixXd& initial, const ControllerConfig& config)
    : rate_(config.adaptation_gain),
      leak_(config.sigma),
      dead_zone_nm_(config.adaptation_dead_zone_nm),
      bound_(config.adaptation_bound),
      K_I0_(initial),
      K_I_(initial) {}

void AdaptiveGain::Update(const Eigen::Vector2d& v, const Regressor& r) noexcept {
  K_I_ -= leak_ * (K_I_ - K_I0_);
  if (r.head<2>().norm() < dead_zone_nm_) return;
  K_I_ += (rate_ * v).lazyProduct(r.transpose());
  const double distance = change();
  if (distance > bound_) K_I_ = K_I0_ + (bound_ / distance) * (K_I_ - K_I0_);
}

double AdaptiveGain::energy() const noexcept {
  return rate_ > 0.0 ? (K_I_ - K_I0_).squaredNorm() / rate_ : 0.0;
}

}  // namespace flexarm
