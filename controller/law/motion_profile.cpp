#include "controller/law/motion_profile.h"

#include <algorithm>
#include <cstddef>

namespace flexarm {

std::vector<double> QuinticAccelerations(int n, double period_s) {
  const auto y = [n](int k) {
    const double x = std::clamp(static_cast<double>(k) / (n - 1), 0.0, 1.0);
    return x * x * x * (10.0 + x * (6.0 * x - 15.0));
  };
  std::vector<double> values(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    values[static_cast<std::size_t>(k)] =
        ((y(k + 1) - y(k)) - (y(k) - y(k - 1))) / (period_s * period_s);
  }
  return values;
}

}  // namespace flexarm
