#pragma once

#include <optional>
#include <string>

#include "controller/types/commissioning_config.h"
#include "controller/types/control_config.h"
#include "controller/types/csv_import_config.h"
#include "hal/sim/sim_config.h"
#include "hal/wired/hal_config.h"

namespace flexarm {

/// A rig: everything that one config file says. Each struct belongs to the folder that uses it and
/// owns its rules.
struct RigConfig : ControlConfig {
  SimConfig sim;
  HalConfig hal;
  CommissioningConfig commissioning;
  DaemonConfig daemon;
  std::optional<CsvImport> csv;  ///< table [csv]: how to read what another recorder wrote
  std::string rig_name;          ///< key rig.name
  std::string backend;           ///< key hal.backend: "sim", "wired", or "" when there is no [hal]
  /// The merged, overridden file as TOML: reading it again gives the same RigConfig. Logged.
  std::string text;
};

}  // namespace flexarm
