#include "estimator/counter_decoder.h"

#include <cmath>
#include <numbers>

namespace flexarm {

CounterDecoder::CounterDecoder(const SensorConfig& sensors, double period_s, double max_rate_rad_s)
    : period_s_(period_s) {
  for (const EncoderConfig& encoder : sensors.encoder) {
    Channel& channel = channel_[static_cast<std::size_t>(encoder.counter)];
    const double step = 2.0 * std::numbers::pi / encoder.counts_per_turn;
    channel.rad_per_count = encoder.sign * step;
    channel.modulus = std::int64_t{1} << encoder.counter_bits;
    channel.max_counts_per_period = max_rate_rad_s * period_s / step;
  }
}

void CounterDecoder::Reset(const std::array<std::int64_t, kCounters>& counts,
                           const std::array<std::int64_t, kCounters>& zero) noexcept {
  for (std::size_t i = 0; i < channel_.size(); ++i) {
    channel_[i].count = counts[i];
    channel_[i].zero = zero[i];
    channel_[i].last_change = 0;
    channel_[i].missing = 0;
  }
}

DecodedCounters CounterDecoder::Decode(const SensorFrame& frame) noexcept {
  DecodedCounters out{};
  for (std::size_t i = 0; i < channel_.size(); ++i) DecodeChannel(i, frame, &out);
  return out;
}

void CounterDecoder::DecodeChannel(std::size_t i, const SensorFrame& frame,
                                   DecodedCounters* out) noexcept {
  Channel& c = channel_[i];
  const std::uint32_t bit = std::uint32_t{1} << i;
  if (c.rad_per_count != 0.0 && (frame.counter_valid & bit) != 0) {
    const int periods = c.missing + 1;
    const std::int64_t expected = c.count + c.missing * c.last_change;
    // The unwrapped count congruent to the raw one and nearest to the expected one.
    const std::int64_t raw = static_cast<std::int64_t>(frame.counter[i]) % c.modulus;
    std::int64_t ahead = (raw - expected) % c.modulus;
    if (ahead < 0) ahead += c.modulus;
    if (ahead >= c.modulus / 2) ahead -= c.modulus;
    const std::int64_t change = expected + ahead - c.count;

    if (std::fabs(static_cast<double>(change)) <= c.max_counts_per_period * periods) {
      c.count += change;
      c.last_change = change / periods;
      out->rate_rad_s[i] = static_cast<double>(change) * c.rad_per_count / (period_s_ * periods);
      c.missing = 0;
      out->good |= bit;
    } else {
      out->jumped |= bit;
    }
  }
  if ((out->good & bit) == 0) ++c.missing;
  out->counts[i] = c.count;
  out->angle_rad[i] = static_cast<double>(c.count - c.zero) * c.rad_per_count;
  out->missing_ticks[i] = c.missing;
}

}  // namespace flexarm
