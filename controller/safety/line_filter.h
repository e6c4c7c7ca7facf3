#pragma once

#include <algorithm>

#include "hal/sensor_frame.h"

namespace flexarm {

/// What a line counts as, from its samples at 1 kHz: an interference of 1 us under a motor cable
/// spoils one sample, a contact that opens does not close again a millisecond later.
///
/// A switch is open, or closed again, when 2 of the last 3 samples say so: at its second sample,
/// at most 2 ms after it moved. Samples before the first count as open. The reset button is pressed
/// when 50 samples in a row say so; before the first released sample it counts as pressed, which
/// resets nothing. Pure, without a clock. Real-time: safe.
class LineFilter {
 public:
  static constexpr int kPressSamples = 50;
  /// From a press to the sample at which it counts, and one period more.
  static constexpr std::int64_t kPressNs = kPressSamples * std::int64_t{1'000'000};

  /// Takes the levels of one tick. @returns what the lines count as
  constexpr LineLevels Next(LineLevels sample) noexcept {
    const LineLevels two_of_three =
        (sample & before_) | (sample & before_that_) | (before_ & before_that_);
    before_that_ = before_;
    before_ = sample;
    samples_ = std::min(samples_ + 1, 3);
    pressed_ = (sample & kButton) != 0 ? std::min(pressed_ + 1, kPressSamples) : 0;
    return (two_of_three & kHealthyLevels) | (pressed_ == kPressSamples ? kButton : 0);
  }

  /// False until there were 3 samples: a switch that counts as open may not be.
  constexpr bool known() const noexcept { return samples_ == 3; }

 private:
  static constexpr LineLevels kButton = LineBit(Line::kResetButton);

  LineLevels before_ = 0, before_that_ = 0;
  int samples_ = 0;
  int pressed_ = kPressSamples;  // samples in a row
};

}  // namespace flexarm
