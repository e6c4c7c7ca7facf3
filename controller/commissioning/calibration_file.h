#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "estimator/calibration.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// What every calibration has near its start.
inline constexpr const char* kCalibrationMark = R"("flexarm": "calibration")";

/// A calibration as the text of its file.
std::string CalibrationText(const SensorConfig& sensors, const Calibration& calibration);

/// Replaces the file atomically, so that a power failure leaves the old one or the new one. The
/// nine before it stay beside it, as FILE.1 (the newest) to FILE.9.
/// @throws InputError if it cannot be written, if the file that is there is no calibration, or if
///   OutOfRange names a value
void WriteCalibration(const std::filesystem::path& file, const SensorConfig& sensors,
                      const Calibration& calibration);

/// Nothing if there is no such file.
/// @throws InputError naming the place and what was expected; also if the file is for other
/// sensors,
///   or has a value that OutOfRange names
std::optional<Calibration> ReadCalibration(const std::filesystem::path& file,
                                           const SensorConfig& sensors);

}  // namespace flexarm
