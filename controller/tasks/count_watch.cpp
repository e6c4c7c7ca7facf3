#include "controller/tasks/count_watch.h"

#include <algorithm>
#include <numbers>

namespace flexarm {

CountWatch::CountWatch(const SensorConfig& sensors) {
  for (const EncoderConfig& encoder : sensors.encoder) {
    Counter& counter = counter_[static_cast<std::size_t>(encoder.counter)];
    counter.modulus = std::int64_t{1} << encoder.counter_bits;
    counter.most_counts = kRestTurnRad * encoder.counts_per_turn / (2.0 * std::numbers::pi);
  }
}

void CountWatch::Take(const SensorFrame& part) noexcept {
  for (std::size_t i = 0; i < counter_.size(); ++i) {
    Counter& counter = counter_[i];
    const std::uint32_t bit = std::uint32_t{1} << i;
    if ((part.counter_valid & bit) == 0) continue;
    const std::int64_t raw = static_cast<std::int64_t>(part.counter[i]) % counter.modulus;
    if ((compare_ & seen_ & bit) != 0) {
      const std::int64_t up = (raw - counter.last + counter.modulus) % counter.modulus;
      const std::int64_t apart = std::min(up, counter.modulus - up);
      if (static_cast<double>(apart) > counter.most_counts) ++epochs_[i];
    }
    compare_ &= ~bit;
    seen_ |= bit;
    counter.last = raw;
  }
}

}  // namespace flexarm
