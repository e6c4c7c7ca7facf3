#include "estimator/strain_scale.h"

namespace flexarm {

StrainScale StrainScaleOf(const SensorConfig& sensors, std::size_t channel) {
  const StrainChannelConfig& row = sensors.strain[channel];
  return {.unit_per_count = row.face * sensors.strain_input.volts_per_count() / row.gain_v_per_unit,
          .offset_counts = row.offset_counts};
}

StrainScale Calibrated(const StrainScale& config, const Calibration& calibration,
                       std::size_t channel) noexcept {
  const auto gain_error = static_cast<double>(calibration.strain_gain_error[channel]);
  const auto zero_counts = static_cast<double>(calibration.strain_zero_counts[channel]);
  return {.unit_per_count = config.unit_per_count / (1.0 + gain_error),
          .offset_counts = config.offset_counts + zero_counts};
}

}  // namespace flexarm
