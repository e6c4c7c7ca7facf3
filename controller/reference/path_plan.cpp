#include "controller/reference/path_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

namespace flexarm {

RigidPoint PathPlan::AtPathTime(double periods, double period_s) const noexcept {
  const auto after = std::upper_bound(
      moves.begin(), moves.end(), periods,
      [](double at, const PlannedMove& move) { return at < static_cast<double>(move.first); });
  if (after == moves.begin()) {
    return {.angle_rad = start_rad, .rate_rad_s = {}, .acceleration_rad_s2 = {}, .jerk_rad_s3 = {}};
  }
  return std::prev(after)->At(periods, period_s);
}

RigidPoint PathPlan::At(int sample, double period_s) const noexcept {
  const PathInstant now = time.At(sample);
  RigidPoint point = AtPathTime(now.periods, period_s);
  const double r = now.rate, a = now.acceleration / period_s, j = now.jerk / (period_s * period_s);
  for (std::size_t i = 0; i < 2; ++i) {
    const double d1 = point.rate_rad_s[i], d2 = point.acceleration_rad_s2[i],
                 d3 = point.jerk_rad_s3[i];
    point.rate_rad_s[i] = d1 * r;
    point.acceleration_rad_s2[i] = d2 * r * r + d1 * a;
    point.jerk_rad_s3[i] = d3 * r * r * r + 3.0 * d2 * r * a + d1 * j;
  }
  return point;
}

int PathPlan::FirstSampleAt(double periods, int from) const noexcept {
  const int settled = std::max(time.settled(), from);
  for (int k = from; k < settled; ++k) {
    if (time.At(k).periods >= periods) return k;
  }
  const double left = periods - time.At(settled).periods;
  if (left <= 0.0) return settled;
  if (time.speed() == 0.0) return std::numeric_limits<int>::max();
  return settled + static_cast<int>(std::ceil(left / time.speed() - 1e-9));
}

}  // namespace flexarm
