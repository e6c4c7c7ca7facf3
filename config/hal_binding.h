#pragma once

#include <string>

#include "config/table_reader.h"
#include "hal/wired/hal_config.h"

namespace flexarm {

/// Reads [hal]: the backend's name, and the buses, devices and lines of a hardware rig.
/// @param period_ms  of the loop; the buses run at the same period
void ReadHal(TableReader hal, double period_ms, std::string* backend, HalConfig* out);

}  // namespace flexarm
