#include "estimator/tip_reading.h"

namespace flexarm {

std::optional<double> TipReading(const SensorFrame& frame,
                                 const TipAccelerometerConfig& config) noexcept {
  const std::int32_t counts = frame.accelerometer[0];
  if ((frame.accelerometer_valid & 1u) == 0) return std::nullopt;
  if (counts <= config.lowest_count() || counts >= config.highest_count()) return std::nullopt;
  return config.m_s2_per_count() * counts;
}

}  // namespace flexarm
