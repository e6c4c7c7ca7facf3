#pragma once

#include <optional>
#include <string>

#include "controller/types/commissioning_config.h"
#include "controller/types/control_config.h"
#include "controller/types/csv_import_config.h"
#include "controller/types/health_config.h"
#include "controller/types/telemetry_config.h"
#include "hal/sim/sim_config.h"
#include "hal/wired/hal_config.h"

namespace flexarm {

/// Configuration of a rig: the contents of one config file. Each struct belongs to the folder that
/// uses it and checks its own rules.
struct RigConfig : ControlConfig {
  SimConfig sim;
  HalConfig hal;
  CommissioningConfig commissioning;
  DaemonConfig daemon;
  TelemetryConfig telemetry;
  HealthConfig health;
  std::optional<CsvImport> csv;  ///< table [csv]: how to read CSV files of another recorder
  std::string rig_name;          ///< key rig.name
  std::string backend;           ///< key hal.backend: "sim", "wired", or "" when there is no [hal]
  /// The merged, overridden file as TOML: reading it again gives the same RigConfig. Logged.
  std::string text;
};

}  // namespace flexarm
