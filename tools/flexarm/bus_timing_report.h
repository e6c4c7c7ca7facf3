#pragma once

#include <nlohmann/json.hpp>

#include "config/config.h"

namespace flexarm {

/// What `config check` says of a wired rig: "acquisition", the time that every bus, device and
/// channel takes and what there is; "drives", how torques become volts or per mille. Nothing if the
/// rig is not wired.
void AddWiring(const RigConfig& config, nlohmann::ordered_json* json);

/// The same for people, to stdout.
void PrintWiring(const nlohmann::ordered_json& json);

}  // namespace flexarm
