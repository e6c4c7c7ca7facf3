#include "controller/reference/retarget.h"

#include <algorithm>
#include <cstddef>

namespace flexarm {

RigidPoint SepticToRest(const RigidPoint& from, const std::array<double, 2>& to_rad,
                        double duration_s, double time_s) noexcept {
  const double T = duration_s;
  const double x = std::clamp(time_s / T, 0.0, 1.0), w = 1.0 - x;
  RigidPoint out{};
  for (std::size_t i = 0; i < 2; ++i) {
    // Taylor coefficients of Y - to over x.
    const double a0 = from.angle_rad[i] - to_rad[i], a1 = from.rate_rad_s[i] * T,
                 a2 = from.acceleration_rad_s2[i] * T * T / 2.0,
                 a3 = from.jerk_rad_s3[i] * T * T * T / 6.0;
    const double c0 = a0, c1 = a1 + 4.0 * a0, c2 = a2 + 4.0 * a1 + 10.0 * a0,
                 c3 = a3 + 4.0 * a2 + 10.0 * a1 + 20.0 * a0;
    const double c = c0 + x * (c1 + x * (c2 + x * c3)), dc = c1 + x * (2.0 * c2 + x * 3.0 * c3),
                 ddc = 2.0 * c2 + x * 6.0 * c3, dddc = 6.0 * c3;
    out.angle_rad[i] = to_rad[i] + w * w * w * w * c;
    out.rate_rad_s[i] = w * w * w * (w * dc - 4.0 * c) / T;
    out.acceleration_rad_s2[i] = w * w * (w * (w * ddc - 8.0 * dc) + 12.0 * c) / (T * T);
    out.jerk_rad_s3[i] =
        w * (w * (w * (w * dddc - 12.0 * ddc) + 36.0 * dc) - 24.0 * c) / (T * T * T);
  }
  return out;
}

}  // namespace flexarm
