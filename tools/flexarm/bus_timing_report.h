#pragma once

#include <nlohmann/json.hpp>

#include "config/config.h"

namespace flexarm {

/// Adds the figures of a hardware rig to the JSON of `config check`: "acquisition", the time that
/// every bus, device and channel takes and the time available; "drives", the scaling of torques to
/// volts or per mille. Adds nothing if [hal] declares no devices.
void AddWiring(const RigConfig& config, nlohmann::ordered_json* json);

/// Prints the same as text to stdout.
void PrintWiring(const nlohmann::ordered_json& json);

}  // namespace flexarm
