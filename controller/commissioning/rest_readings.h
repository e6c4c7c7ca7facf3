#pragma once

#include <array>
#include <cstdint>

#include "controller/types/records.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Sensor readings of an arm at rest, averaged over some samples.
struct RestReadings {
  int ticks;
  std::array<double, kMaxStrainChannels> strain_mean;   ///< raw counts
  std::array<double, kMaxStrainChannels> strain_sigma;  ///< standard deviation
  std::array<int, kMaxStrainChannels> strain_missing;   ///< samples without a valid reading
  std::array<std::int64_t, kCounters> counts;           ///< unwrapped, of the last valid reading
  std::array<std::int64_t, kCounters> travel_counts;    ///< largest minus smallest
  std::array<int, kCounters> counter_missing;           ///< samples without a valid reading
};

/// Collects RestReadings. Not designed as real-time safe, because no caller needs it.
class RestMeter {
 public:
  /// @param ticks  to average over, at least 2
  explicit RestMeter(int ticks) : wanted_(ticks) {}

  /// True if this was the last sample that was needed.
  bool Take(const TickRecord& tick);

  bool started() const { return ticks_ > 0; }
  RestReadings Result() const;

 private:
  int wanted_;
  int ticks_ = 0;
  std::array<double, kMaxStrainChannels> sum_{};
  std::array<double, kMaxStrainChannels> sum_of_squares_{};
  std::array<int, kMaxStrainChannels> valid_{};
  std::array<std::int64_t, kCounters> lowest_{};
  std::array<std::int64_t, kCounters> highest_{};
  std::array<std::int64_t, kCounters> counts_{};
  std::array<int, kCounters> counter_valid_{};
};

}  // namespace flexarm
