#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "hal/sensor_frame.h"

namespace flexarm {

/// Measured zeros and gains of a rig's sensors, relative to its config. All zero: none measured.
///
///   joint angle = sign * 2 pi / counts_per_turn * (unwrapped counts - counter_zero)
///   counts      = (1 + strain_gain_error) * (counts of the config) + strain_zero_counts
///
/// Recorded in every StepInput; a reset of the loop adopts it. The layout has no padding.
struct Calibration {
  std::array<std::int64_t, kCounters> counter_zero;  ///< unwrapped counts at angle 0
  std::array<float, kMaxStrainChannels>
      strain_zero_counts;                                   ///< added to the config's offset_counts
  std::array<float, kMaxStrainChannels> strain_gain_error;  ///< measured gain / config's gain - 1

  friend bool operator==(const Calibration&, const Calibration&) = default;
};
static_assert(std::is_trivially_copyable_v<Calibration>);
static_assert(sizeof(Calibration) == 8 * kCounters + 2 * 4 * kMaxStrainChannels,
              "no padding: the bytes are logged and compared");

}  // namespace flexarm
