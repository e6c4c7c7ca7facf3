#pragma once

namespace flexarm {

/// Progress along a path at one sample.
struct PathInstant {
  double periods;       ///< path time: periods of the plan that lie behind
  double rate;          ///< its derivatives over the samples; 1 at the planned speed, 0 at rest
  double acceleration;  ///< per period
  double jerk;          ///< per period squared
};

/// Path time over the samples of a run: at a constant speed, but for one change of it.
///
/// The speed changes as s(x) of the septic profile (motion_profile.h), so the acceleration and the
/// jerk of the path stay continuous: a smooth path needs a smooth torque. Real-time: safe.
class PathTime {
 public:
  /// Sample k is `speed` k periods along the path. @param speed  share of the planned one
  explicit PathTime(double speed) noexcept : before_(speed), speed_(speed) {}

  /// The same until `sample`; from there the speed changes to `speed` over `periods` samples.
  /// @pre sample >= settled(), periods > 0
  PathTime WithSpeed(int sample, double speed, int periods) const noexcept;

  /// The same progress, counted so that `sample` is that many periods along the path.
  /// @pre sample >= settled()
  PathTime CountedFrom(int sample) const noexcept;

  /// @pre sample is not before the change
  PathInstant At(int sample) const noexcept;

  /// Speed after the change.
  double speed() const noexcept { return speed_; }

  /// First sample from which the speed is constant.
  int settled() const noexcept { return first_ + over_; }

 private:
  int first_ = 0, over_ = 0;  // of the change
  double behind_ = 0.0;       // path time at first_
  double before_, speed_;     // before and after the change
};

}  // namespace flexarm
