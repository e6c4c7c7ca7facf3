#include "controller/reference/path_time.h"

#include "controller/types/motion_profile.h"

namespace flexarm {
namespace {

// Integral of the septic profile from 0 to x, 0 .. 1.
double SepticIntegral(double x) noexcept {
  const double x4 = x * x * x * x;
  return x4 * x * (7.0 + x * (-14.0 + x * (10.0 - 2.5 * x)));
}

}  // namespace

PathTime PathTime::WithSpeed(int sample, double speed, int periods) const noexcept {
  PathTime changed = *this;
  changed.behind_ = At(sample).periods;
  changed.first_ = sample;
  changed.over_ = periods;
  changed.before_ = speed_;
  changed.speed_ = speed;
  return changed;
}

PathTime PathTime::CountedFrom(int sample) const noexcept {
  PathTime counted(speed_);
  counted.first_ = sample;
  counted.behind_ = sample;
  return counted;
}

PathInstant PathTime::At(int sample) const noexcept {
  const double since = sample - first_;
  if (since >= over_) {
    const double changing = 0.5 * over_ * (before_ + speed_);  // the integral of s is 1/2
    return {.periods = behind_ + changing + (since - over_) * speed_,
            .rate = speed_,
            .acceleration = 0.0,
            .jerk = 0.0};
  }
  const double by = speed_ - before_, n = over_, x = since / n;
  const ProfilePoint profile = ProfileAt(MoveProfile::kSeptic, x);
  return {.periods = behind_ + before_ * since + by * n * SepticIntegral(x),
          .rate = before_ + by * profile.s,
          .acceleration = by * profile.ds / n,
          .jerk = by * profile.dds / (n * n)};
}

}  // namespace flexarm
