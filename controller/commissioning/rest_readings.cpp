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
  counts_ = tick.output.counts;
  for (std::size_t i = 0; i < kCounters; ++i) {
    lowest_[i] = started() ? std::min(lowest_[i], counts_[i]) : counts_[i];
    highest_[i] = started() ? std::max(highest_[i], counts_[i]) : counts_[i];
  }
  counters_good_ &= tick.output.counters_used;
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
  for (std::size_t i = 0; i < kCounters; ++i) out.travel_counts[i] = highest_[i] - lowest_[i];
  out.counters_good = ticks_ > 0 ? counters_good_ : 0;
  return out;
}

}  // namespace flexarm
