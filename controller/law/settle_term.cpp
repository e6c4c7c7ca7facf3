#include "controller/law/settle_term.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "estimator/settling_observer.h"
#include "model/math/portable_math.h"

namespace flexarm {
namespace {

// The friction acts against a hub that would turn faster than this: much less than the 0.04 rad/s
// of one sample of torque equal to the friction.
constexpr double kTurns_rad_s = 0.007;

GainTable SettleGains(const Design& design) {
  if (!design.settle_gains) throw std::invalid_argument("SettleTerm: a design without its gains");
  return *design.settle_gains;
}

}  // namespace

SettleTerm::SettleTerm(const Design& design, const SettlingConfig& config, TipSway sway,
                       double friction_nm, double period_s)
    : gains_(SettleGains(design)),
      config_(config),
      friction_nm_(friction_nm),
      period_s_(period_s),
      hub_after_(design.A.row(0)),
      hub_by_torque_(design.B.row(0)),
      sway_(std::move(sway)) {}

void SettleTerm::Reset() noexcept {
  gains_share_ = 0.0;
  compensates_ = false;
  held_ = false;
}

void SettleTerm::Judge(double sway_mm) noexcept {
  if (gains_share_ > 0.0 || sway_mm < config_.acts_below_mm) {
    gains_share_ = std::min(1.0, gains_share_ + period_s_ / kSettlingFadesIn_s);
  }
  held_ =
      gains_share_ >= 1.0 && sway_mm < (held_ ? config_.release_above_mm : config_.hold_below_mm);
  compensates_ = !held_ && sway_mm < config_.acts_below_mm;
}

// @param u  the torque without friction compensation
double SettleTerm::FrictionTorque(const State& x, const Eigen::Vector2d& u,
                                  double estimated_nm) const noexcept {
  const double turns_rad = hub_after_.dot(x) + hub_by_torque_.dot(u) - x(0);
  return std::min(friction_nm_, estimated_nm) *
         PortableMath::Tanh(turns_rad / (period_s_ * kTurns_rad_s));
}

Eigen::Vector2d SettleTerm::Torque(const StateVector& x, const StateVector& x_m, double share,
                                   const Eigen::Vector2d& feedback_nm,
                                   const Eigen::Vector2d& wanted_nm,
                                   const PayloadKnowledge& payload) noexcept {
  if (share <= 0.0 || x.size() != State::RowsAtCompileTime) {
    Reset();
    return Eigen::Vector2d::Zero();
  }
  const State now = x.head<12>();
  const State off = x_m.head<12>() - now;
  Judge(1e3 * sway_.Amplitude_m(now.head<6>(), now.tail<6>()));
  Eigen::Vector2d add = gains_.At(payload.payload_kg, now(1)).lazyProduct(off);
  add = gains_share_ * (add - feedback_nm);
  if (compensates_) add(0) += FrictionTorque(now, wanted_nm + add, payload.friction_nm[0]);
  return add;
}

}  // namespace flexarm
