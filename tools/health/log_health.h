#pragma once

#include <filesystem>

#include "config/config.h"
#include "controller/health/health_history.h"

namespace flexarm {

/// What a run log tells of the rig's health.
struct LogHealth {
  RigConfig config;  ///< of the log
  HealthRecord record;
  RunFigures figures;
};

/// Runs the parallel plant beside a log, with the payload that the run states: that of the
/// simulated arm, or on a rig that of the config.
/// @throws InputError if the log cannot be read; ConfigError if its config cannot
LogHealth HealthOfLog(const std::filesystem::path& file);

/// The nominal plant of a config with a payload.
NominalPlant NominalPlantOf(const RigConfig& config, double payload_kg);

}  // namespace flexarm
