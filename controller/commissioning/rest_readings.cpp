#include "controller/commissioning/rest_readings.h"

#include <algorithm>
#include <cmath>

namespace flexarm {

bool RestMeter::Take(const TickRecord& tick) {
  const SensorFrame& frame = tick.input.frame;
  for (std::size_t i = 0; i < kMaxStrainChannels; ++i) {
    if ((frame.strain_valid >> i & 1u) == 0) continue;
    const auto counts = static_cast<double>(frame.strain[i]);
    sum_[i] += counts;
    sum_of_squares_[i] += counts * counts;  // exact: 24-bit counts, a few thousand of them
    ++valid_[i];
  }
  for (std::size_t i = 0; i < kCounters; ++i) {
    if ((tick.output.counters_used >> i & 1u) == 0) continue;
    const std::int64_t counts = tick.output.counts[i];
    const bool first = counter_valid_[i]++ == 0;
    lowest_[i] = first ? counts : std::min(lowest_[i], counts);
    highest_[i] = first ? counts : std::max(highest_[i], counts);
    counts_[i] = counts;
  }
  return ++ticks_ >= wanted_;
}

RestReadings RestMeter::Result() const {
  RestReadings out{};
  out.ticks = ticks_;
  for (std::size_t i = 0; i < kMaxStrainChannels; ++i) {
    out.strain_missing[i] = ticks_ - valid_[i];
    if (valid_[i] == 0) continue;
    out.strain_mean[i] = sum_[i] / valid_[i];
    const double variance =
        sum_of_squares_[i] / valid_[i] - out.strain_mean[i] * out.strain_mean[i];
    out.strain_sigma[i] = std::sqrt(std::max(variance, 0.0));
  }
  out.counts = counts_;
  for (std::size_t i = 0; i < kCounters; ++i) {
    out.travel_counts[i] = highest_[i] - lowest_[i];
    out.counter_missing[i] = ticks_ - counter_valid_[i];
  }
  return out;
}

}  // namespace flexarm
