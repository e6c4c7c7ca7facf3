#include "controller/reference/duration_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flexarm {

double DurationTable::At(double point) const noexcept {
  constexpr double kLast = kPayloads - 1;
  const double at = std::clamp(point, 0.0, kLast);
  const auto below = static_cast<std::size_t>(std::min(at, kLast - 1.0));
  const double share = at - static_cast<double>(below);
  return (1.0 - share) * periods_[below] + share * periods_[below + 1];
}

int DurationTable::Between(double low_kg, double high_kg) const noexcept {
  const bool known = std::isfinite(low_kg) && std::isfinite(high_kg);
  const double points_per_kg = (kPayloads - 1) / max_kg_;
  const double low = known ? low_kg * points_per_kg : 0.0;
  const double high = known ? high_kg * points_per_kg : kPayloads - 1.0;
  double most = std::max(At(low), At(high));
  for (std::size_t i = 0; i < periods_.size(); ++i) {
    const auto point = static_cast<double>(i);
    if (point > low && point < high) most = std::max<double>(most, periods_[i]);
  }
  constexpr double kRounding = 1e-9;
  return static_cast<int>(std::ceil(most - kRounding));
}

void DurationTable::LimitTo(int most) noexcept {
  for (std::int16_t& periods : periods_) {
    periods = static_cast<std::int16_t>(std::min<int>(periods, most));
  }
}

}  // namespace flexarm
