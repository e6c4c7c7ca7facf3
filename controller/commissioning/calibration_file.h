#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "estimator/calibration.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// Replaces the file atomically, so that a power failure leaves the old one or the new one.
/// @throws InputError if it cannot be written
void WriteCalibration(const std::filesystem::path& file, const SensorConfig& sensors,
                      const Calibration& calibration);

/// Nothing if there is no such file.
/// @throws InputError naming the place and what was expected; also if the file is for other sensors
std::optional<Calibration> ReadCalibration(const std::filesystem::path& file,
                                           const SensorConfig& sensors);

}  // namespace flexarm
