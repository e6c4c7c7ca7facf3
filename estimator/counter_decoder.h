#pragma once

#include <array>
#include <cstdint>

#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Joint angles decoded from the counters of one sample.
struct DecodedCounters {
  std::array<double, kCounters> angle_rad;     ///< th1..th4; the last good value if not good
  std::array<std::int64_t, kCounters> counts;  ///< unwrapped
  std::uint32_t good;                          ///< bit i: read, and its change was possible
  std::uint32_t jumped;                        ///< bit i: changed faster than the joint can turn
  std::array<double, kCounters> rate_rad_s;    ///< mean since the last good reading
  std::array<int, kCounters> missing_ticks;    ///< ticks since the last good reading
};

/// Unwraps the encoder counters into joint angles, and rejects impossible jumps.
///
/// A counter of n bits is unwrapped to the value nearest to the expected one: the last count after
/// one period, or the last count extrapolated at the last rate when readings were missed. An
/// encoder that the rig does not have reads 0 and is never good. Real-time: Reset and Decode are
/// safe.
class CounterDecoder {
 public:
  /// @param max_rate_rad_s  a faster mean rate between two readings is a jump
  CounterDecoder(const SensorConfig& sensors, double period_s, double max_rate_rad_s);

  /// Clears rates and missed readings.
  /// @param counts  the last unwrapped counts
  /// @param zero    the unwrapped counts at which the joints are at zero (Calibration)
  void Reset(const std::array<std::int64_t, kCounters>& counts,
             const std::array<std::int64_t, kCounters>& zero) noexcept;

  DecodedCounters Decode(const SensorFrame& frame) noexcept;

 private:
  struct Channel {
    double rad_per_count = 0.0;  // signed; 0: no such encoder
    std::int64_t modulus = 1;
    double max_counts_per_period = 0.0;
    std::int64_t count = 0;
    std::int64_t zero = 0;
    std::int64_t last_change = 0;  // counts a period, from the last good reading
    int missing = 0;
  };

  void DecodeChannel(std::size_t i, const SensorFrame& frame, DecodedCounters* out) noexcept;

  double period_s_;
  std::array<Channel, kCounters> channel_;
};

}  // namespace flexarm
