#include "controller/health/quantised_residual.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flexarm {
namespace {

constexpr double kFar = 6.0;  // sigmas beyond the interval: the normal tail is as good as its edge
constexpr double kLeast = 1e-6;  // of the information of a reading without rounding

double Density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi); }

}  // namespace

QuantisedResidual Quantised(double away, double count, double sigma) {
  const double a = (away - 0.5 * count) / sigma, b = (away + 0.5 * count) / sigma;
  if (a > kFar) return {.residual = a, .weight = 1.0 / sigma};
  if (b < -kFar) return {.residual = b, .weight = 1.0 / sigma};
  const double inside =
      0.5 * (std::erfc(-b / std::numbers::sqrt2) - std::erfc(-a / std::numbers::sqrt2));
  if (inside <= 0.0)
    return {.residual = std::fabs(a) < std::fabs(b) ? a : b, .weight = 1.0 / sigma};
  const double score = (Density(a) - Density(b)) / inside;
  const double spread = 1.0 + (a * Density(a) - b * Density(b)) / inside - score * score;
  const double information = std::clamp(1.0 - spread, kLeast, 1.0);
  return {.residual = score / std::sqrt(information), .weight = std::sqrt(information) / sigma};
}

}  // namespace flexarm
