#include "config/derivation/sensor_scales.h"

#include <algorithm>
#include <cmath>

#include "model/units.h"

namespace flexarm {

double FullScaleStrain(const SensorConfig& sensors, const StrainChannelConfig& channel) {
  const double counts = sensors.strain_input.highest_count() - std::abs(channel.offset_counts);
  return counts * sensors.strain_input.volts_per_count() / std::abs(channel.gain_v_per_unit);
}

double StrainNoise(const SensorConfig& sensors) {
  double noise = 0.0;
  for (const StrainChannelConfig& channel : sensors.strain) {
    const double counts = std::max(1.0, sensors.strain_input.noise_counts);
    const double volts = counts * sensors.strain_input.volts_per_count();
    noise = std::max(noise, volts / std::abs(channel.gain_v_per_unit));
  }
  return noise;
}

double AmbiguousRate_rad_s(const EncoderConfig& encoder, double period_s) {
  const double half_range_rad =
      std::ldexp(kTwoPi / encoder.counts_per_turn, encoder.counter_bits - 1);
  return half_range_rad / period_s;
}

}  // namespace flexarm
