#pragma once

#include <string>

#include "controller/law/design.h"
#include "controller/types/records.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// Description of rig and controller for the log of a run.
/// @param clock  "monotonic" or "simulated"
RunInfo MakeRunInfo(const RigConfig& config, const Design& design, const std::string& clock,
                    const std::string& backend);

}  // namespace flexarm
