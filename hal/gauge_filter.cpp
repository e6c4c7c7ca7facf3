#include "hal/gauge_filter.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace flexarm {
namespace {

// exp(h [0 1; -w^2 -2 zeta w]), any zeta > 0: complex frequencies above zeta = 1.
Eigen::Matrix2d SecondOrderDecay(double w, double zeta, double h) {
  const std::complex<double> damped = w * std::sqrt(std::complex<double>(1.0 - zeta * zeta));
  const double sine =
      std::abs(damped) > 0.0 ? std::real(std::sin(damped * h) / damped) : h;  // sin(wd h) / wd
  const double cosine = std::real(std::cos(damped * h)), drag = zeta * w;
  Eigen::Matrix2d decay;
  decay << cosine + drag * sine, sine, -w * w * sine, cosine - drag * sine;
  return std::exp(-drag * h) * decay;
}

}  // namespace

GaugeFilter::GaugeFilter(const StrainInputConfig& input, double step_s, Eigen::Index size)
    : order_(input.filter_hz <= 0.0       ? Order::kNone
             : input.filter_damping > 0.0 ? Order::kSecond
                                          : Order::kFirst),
      decay_(Eigen::Matrix2d::Zero()),
      before_(Signals::Zero(size)),
      output_(Signals::Zero(size)),
      rate_(Signals::Zero(size)) {
  const double w = 2.0 * std::numbers::pi * input.filter_hz;
  if (order_ == Order::kFirst) blend_ = 1.0 - std::exp(-w * step_s);
  if (order_ == Order::kSecond) decay_ = SecondOrderDecay(w, input.filter_damping, step_s);
}

void GaugeFilter::Settle(const Signals& input) noexcept {
  before_ = output_ = input;
  rate_.setZero();
}

void GaugeFilter::Step(const Signals& input) noexcept {
  if (order_ == Order::kNone) {
    output_ = input;
    return;
  }
  for (Eigen::Index i = 0; i < input.size(); ++i) {
    const double middle = 0.5 * (before_[i] + input[i]);
    before_[i] = input[i];
    if (order_ == Order::kFirst) {
      output_[i] += blend_ * (middle - output_[i]);
      continue;
    }
    const double away = output_[i] - middle, rate = rate_[i];
    output_[i] = middle + decay_(0, 0) * away + decay_(0, 1) * rate;
    rate_[i] = decay_(1, 0) * away + decay_(1, 1) * rate;
  }
}

}  // namespace flexarm
