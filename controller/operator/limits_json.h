#pragma once

#include <nlohmann/json_fwd.hpp>

#include "controller/types/safety_config.h"

namespace flexarm {

/// "limits" of the status: those that hold, and whether they are reduced (safety.reduced).
nlohmann::json LimitsJson(const SafetyConfig& safety, bool reduced);

}  // namespace flexarm
