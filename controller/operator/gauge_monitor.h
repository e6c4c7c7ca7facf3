#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "controller/types/step_types.h"

namespace flexarm {

/// Notices strain channels that the fit does without: no reading, saturated, stuck or an outlier.
/// The loop goes on as long as the others determine the bending (StrainFit). Real-time safe.
/// Thread: operator.
class GaugeMonitor {
 public:
  /// One lost frame is no news; as many samples in a row as the loop takes to judge a sensor are.
  static constexpr int kTicks = 3;

  /// @param channels  strain channels of the rig
  explicit GaugeMonitor(std::size_t channels) noexcept : channels_(channels) {}

  /// Every step, in order.
  /// @returns bit i: channel i has been missing for kTicks samples; each is told once a run
  std::uint32_t Take(const StepInput& input, const StepOutput& output) noexcept {
    const bool runs = input.safety_state == SafetyState::kRunning;
    if (runs && !runs_) reported_ = 0;
    runs_ = runs;
    std::uint32_t missing = 0;
    for (std::size_t i = 0; i < channels_; ++i) {
      const bool used = (output.strain_used >> i & 1U) != 0;
      ticks_[i] = used ? 0 : (ticks_[i] < kTicks ? ticks_[i] + 1 : kTicks);
      if (ticks_[i] == kTicks) missing |= std::uint32_t{1} << i;
    }
    missing_ = missing;
    const std::uint32_t news = missing & ~reported_;
    reported_ |= news;
    return news;
  }

  /// Bit i: channel i is missing now, and has been for kTicks samples.
  std::uint32_t missing() const noexcept { return missing_; }

 private:
  std::size_t channels_;
  std::array<int, kMaxStrainChannels> ticks_{};
  std::uint32_t missing_ = 0;
  std::uint32_t reported_ = 0;
  bool runs_ = false;
};

}  // namespace flexarm
