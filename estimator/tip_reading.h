#pragma once

#include <optional>

#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// What the accelerometer at the tip shows, m/s^2: nothing if it was not read for this frame, or is
/// at a rail of its converter and so may stand for anything beyond. Real-time: safe.
std::optional<double> TipReading(const SensorFrame& frame,
                                 const TipAccelerometerConfig& config) noexcept;

}  // namespace flexarm
