#pragma once

#include <cstddef>
#include <cstdint>

#include "estimator/calibration.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// What the counts of a strain channel mean: strain = unit_per_count (counts - offset_counts).
///
/// Sign: that of (h/2) w''(x), whichever face the gauge is on. Unit strain.
struct StrainScale {
  double unit_per_count = 0.0;  ///< signed by face and gain
  double offset_counts = 0.0;
};

/// The scale of a channel, counted from 0, by the config alone.
StrainScale StrainScaleOf(const SensorConfig& sensors, std::size_t channel);

/// The same with what was measured of the channel. Real-time: safe.
StrainScale Calibrated(const StrainScale& config, const Calibration& calibration,
                       std::size_t channel) noexcept;

/// Unit strain of a reading. Real-time: safe.
inline double StrainOf(const StrainScale& scale, std::int32_t counts) noexcept {
  return (static_cast<double>(counts) - scale.offset_counts) * scale.unit_per_count;
}

}  // namespace flexarm
