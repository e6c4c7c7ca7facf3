#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "tools/torture/scenario.h"

// A scenario as a JSON object with all that is random in it, so that one which is no longer that of
// its seed runs alone. Instants in milliseconds.

namespace flexarm {

nlohmann::ordered_json ScenarioJson(const TortureScenario& scenario);

/// The scenario of a file. @param gauges  strain channels of the rig. @throws InputError that says
/// where, and what was expected
TortureScenario ReadScenario(const std::filesystem::path& file, int gauges);

}  // namespace flexarm
