#pragma once

#include <string>

#include "config/table_reader.h"
#include "hal/wired/hal_config.h"

namespace flexarm {

/// Reads [hal]: the backend's name and how the rig is wired.
/// @param period_ms  of the loop: buses keep its time
void ReadHal(TableReader hal, double period_ms, std::string* backend, HalConfig* out);

}  // namespace flexarm
