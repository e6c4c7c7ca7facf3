#include "model/arm/straight_arm.h"

#include <cmath>
#include <numbers>

namespace flexarm {

std::optional<std::array<double, 2>> StraightArmAngles(const std::array<double, 2>& length_m,
                                                       const std::array<double, 2>& tip_m,
                                                       ElbowSide elbow) {
  const auto [L1, L2] = length_m;
  const auto [x, y] = tip_m;
  // Law of cosines: r^2 = L1^2 + L2^2 + 2 L1 L2 cos th2.
  const double cosine = (x * x + y * y - L1 * L1 - L2 * L2) / (2.0 * L1 * L2);
  if (!(std::fabs(cosine) <= 1.0)) return std::nullopt;
  const double theta2 = elbow == ElbowSide::kLeft ? -std::acos(cosine) : std::acos(cosine);
  const double theta1 =
      std::atan2(y, x) - std::atan2(L2 * std::sin(theta2), L1 + L2 * std::cos(theta2));
  return std::array{std::remainder(theta1, 2.0 * std::numbers::pi), theta2};
}

}  // namespace flexarm
