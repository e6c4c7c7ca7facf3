#include "controller/design/input_shaper.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

#include "model/math/dense_decompositions.h"
#include "model/units.h"

namespace flexarm {
namespace {

struct Oscillation {
  double half_period;  // samples
  double decay;        // K: amplitude ratio after half a period
};

// A real pole has angle 0, or pi if it alternates with the samples, which no shaper can cancel.
std::vector<Oscillation> SlowestTwo(const Eigen::MatrixXd& closed) {
  std::vector<std::complex<double>> poles;
  for (const std::complex<double> z : closed.eigenvalues()) {
    if (std::arg(z) > 1e-6 && std::arg(z) < kPi - 1e-6) poles.push_back(z);
  }
  if (poles.size() < 2)
    throw std::runtime_error("input shaper: the closed loop has fewer than two oscillatory modes");
  std::sort(poles.begin(), poles.end(),
            [](const auto& a, const auto& b) { return std::arg(a) < std::arg(b); });
  std::vector<Oscillation> slowest;
  for (const std::complex<double> z : {poles[0], poles[1]}) {
    const double half_period = kPi / std::arg(z);
    slowest.push_back({.half_period = half_period, .decay = std::pow(std::abs(z), half_period)});
  }
  return slowest;
}

Eigen::RowVectorXd Convolve(const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b) {
  Eigen::RowVectorXd out = Eigen::RowVectorXd::Zero(a.size() + b.size() - 1);
  for (Eigen::Index i = 0; i < a.size(); ++i) out.segment(i, b.size()) += a(i) * b;
  return out;
}

// Impulses 1 and K, half a period apart, cancel the oscillation.
Eigen::RowVectorXd ZeroVibration(const Oscillation& oscillation) {
  const double whole = std::floor(oscillation.half_period);
  const double share = oscillation.half_period - whole;
  const auto at = static_cast<Eigen::Index>(whole);
  Eigen::RowVectorXd weights = Eigen::RowVectorXd::Zero(at + 2);
  weights(0) = 1.0;
  weights(at) += oscillation.decay * (1.0 - share);
  weights(at + 1) += oscillation.decay * share;
  return weights / weights.sum();
}

}  // namespace

Eigen::RowVectorXd DesignInputShaper(const Eigen::MatrixXd& closed, int derivatives) {
  Eigen::RowVectorXd weights = Eigen::RowVectorXd::Ones(1);
  for (const Oscillation& oscillation : SlowestTwo(closed)) {
    for (int i = 0; i < derivatives; ++i) {
      weights = Convolve(weights, ZeroVibration(oscillation));
    }
  }
  return weights;
}

}  // namespace flexarm
