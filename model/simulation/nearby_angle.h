#pragma once

#include <cmath>

#include "model/math/portable_math.h"

namespace flexarm {

/// Sine and cosine of an angle that hardly changes from one pass to the next.
///
/// The first value is PortableMath's; the others turn it by the difference, whose series are exact
/// to rounding. Real-time: safe.
class NearbyAngle {
 public:
  explicit NearbyAngle(double angle_rad) noexcept
      : angle_(angle_rad), at_(PortableMath::SinCos(angle_rad)) {}

  SineCosine At(double angle_rad) const noexcept {
    // First terms left out, relative to 1: d^5 / 120 and d^6 / 720.
    constexpr double kSmall_rad = 5e-4;
    const double d = angle_rad - angle_;
    if (!(std::fabs(d) < kSmall_rad)) return PortableMath::SinCos(angle_rad);
    const double dd = d * d, sine = d - d * dd * (1.0 / 6.0),
                 less = dd * (0.5 - dd * (1.0 / 24.0));  // 1 - cosine
    return {at_.sine + (at_.cosine * sine - at_.sine * less),
            at_.cosine - (at_.sine * sine + at_.cosine * less)};
  }

 private:
  double angle_;
  SineCosine at_;
};

}  // namespace flexarm
