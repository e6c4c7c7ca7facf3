#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "config/config.h"
#include "controller/commissioning/rest_readings.h"

namespace flexarm {

/// One second of an arm at rest: every strain channel reads `counts` with the noise of the config,
/// every counter its entry of `counters`.
inline RestReadings StillArm(const SensorConfig& sensors, const std::vector<double>& counts,
                             const std::array<std::int64_t, kCounters>& counters = {}) {
  constexpr int kTicks = 50;
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, sensors.strain_input.noise_counts);
  RestMeter meter(kTicks);
  for (int k = 0; k < kTicks; ++k) {
    TickRecord tick{};
    tick.output.counts = counters;
    tick.output.counters_used = 0b1111;
    for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
      tick.input.frame.strain[i] =
          static_cast<std::int32_t>(std::lround(counts[i] + noise(random)));
      tick.input.frame.strain_valid |= 1u << i;
    }
    meter.Take(tick);
  }
  return meter.Result();
}

}  // namespace flexarm
