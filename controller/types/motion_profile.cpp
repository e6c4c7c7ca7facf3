#include "controller/types/motion_profile.h"

#include <algorithm>
#include <cstddef>

namespace flexarm {
namespace {

ProfilePoint Quintic(double x) noexcept {
  return {.s = x * x * x * (10.0 + x * (6.0 * x - 15.0)),
          .ds = x * x * (30.0 + x * (30.0 * x - 60.0)),
          .dds = x * (60.0 + x * (120.0 * x - 180.0)),
          .ddds = 60.0 + x * (360.0 * x - 360.0)};
}

ProfilePoint Septic(double x) noexcept {
  return {.s = x * x * x * x * (35.0 + x * (x * (70.0 - 20.0 * x) - 84.0)),
          .ds = x * x * x * (140.0 + x * (x * (420.0 - 140.0 * x) - 420.0)),
          .dds = x * x * (420.0 + x * (x * (2100.0 - 840.0 * x) - 1680.0)),
          .ddds = x * (840.0 + x * (x * (8400.0 - 4200.0 * x) - 5040.0))};
}

}  // namespace

ProfilePoint ProfileAt(MoveProfile profile, double x) noexcept {
  const double within = std::clamp(x, 0.0, 1.0);
  ProfilePoint point = profile == MoveProfile::kSeptic ? Septic(within) : Quintic(within);
  if (x != within) point.ddds = 0.0;  // the jerk of a quintic is not 0 at its ends
  return point;
}

std::vector<double> ProfileAccelerations(MoveProfile profile, int n, double period_s) {
  std::vector<double> y(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    y[static_cast<std::size_t>(k)] = ProfileAt(profile, static_cast<double>(k) / (n - 1)).s;
  }
  return HeldAccelerations(y, period_s);
}

std::vector<double> HeldAccelerations(const std::vector<double>& y, double period_s) {
  std::vector<double> values(y.size());
  for (std::size_t k = 0; k < y.size(); ++k) {
    const double before = k == 0 ? 0.0 : y[k - 1];
    const double after = k + 1 < y.size() ? y[k + 1] : y.back();
    values[k] = ((after - y[k]) - (y[k] - before)) / (period_s * period_s);
  }
  return values;
}

}  // namespace flexarm
