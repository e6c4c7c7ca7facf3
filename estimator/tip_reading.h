#pragma once

#include <optional>

#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Reading of the accelerometer at the tip, m/s^2; empty if it was not read for this frame, or is
/// at an end of its range, where the acceleration may be larger. Real-time: safe.
std::optional<double> TipReading(const SensorFrame& frame,
                                 const TipAccelerometerConfig& config) noexcept;

}  // namespace flexarm
