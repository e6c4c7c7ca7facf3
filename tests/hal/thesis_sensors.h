#pragma once

#include "hal/sensor_config.h"

namespace flexarm {

/// Corner of the simulated rig's gauge filters.
inline constexpr double kGauge_hz = 20.0;

/// Sensors of the simulated rig (docs/theory/control-law.md 12.1): four encoders, ten gauges per
/// link at the middles of ten equal parts, 12 bit over +-10 V at 5000 V per unit strain.
inline SensorConfig ThesisSensors(double noise_counts = 1.0) {
  SensorConfig sensors;
  sensors.encoder = {{.counter = 0, .counts_per_turn = 2540.0, .counter_bits = 8, .sign = 1},
                     {.counter = 1, .counts_per_turn = 2540.0, .counter_bits = 8, .sign = 1},
                     {.counter = 2, .counts_per_turn = 2540.0, .counter_bits = 8, .sign = 1},
                     {.counter = 3, .counts_per_turn = 24480.0, .counter_bits = 16, .sign = 1}};
  for (int link = 1; link <= 2; ++link) {
    const double length_m = link == 1 ? 0.8 : 0.9;
    for (int i = 0; i < 10; ++i) {
      sensors.strain.push_back({.link = link,
                                .position_m = (i + 0.5) * length_m / 10.0,
                                .face = 1,
                                .gain_v_per_unit = 5000.0,
                                .offset_counts = 0.0});
    }
  }
  sensors.strain_input = {.converter_bits = 12,
                          .range_v = 10.0,
                          .filter_hz = kGauge_hz,
                          .noise_counts = noise_counts,
                          .filter_damping = 0.0};  // of first order
  return sensors;
}

}  // namespace flexarm
