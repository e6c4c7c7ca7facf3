#include "tools/sweep/better_sensors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace flexarm {

std::vector<std::string> FinerEncoders(const SensorConfig& sensors, double times, bool hub1_only) {
  constexpr int kHub1 = 0;  // of the counters
  constexpr int kMostBits = 32;
  const int more_bits = static_cast<int>(std::ceil(std::log2(times)));
  std::vector<std::string> overrides;
  for (std::size_t i = 0; i < sensors.encoder.size(); ++i) {
    const EncoderConfig& encoder = sensors.encoder[i];
    if (hub1_only && encoder.counter != kHub1) continue;
    const std::string row = "sensors.encoder[" + std::to_string(i) + "].";
    std::array<char, 32> counts{};
    std::snprintf(counts.data(), counts.size(), "%.17g", encoder.counts_per_turn * times);
    overrides.push_back(row + "counts_per_turn=" + counts.data());
    const int bits = std::min(kMostBits, encoder.counter_bits + more_bits);
    overrides.push_back(row + "counter_bits=" + std::to_string(bits));
  }
  return overrides;
}

std::vector<std::string> QuietGauges() {
  return {"sensors.strain_input.noise_counts=0", "sensors.strain_input.converter_bits=24"};
}

}  // namespace flexarm
