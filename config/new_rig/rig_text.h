#pragma once

#include <map>
#include <string>

#include "config/config.h"
#include "config/new_rig/arm_description.h"

namespace flexarm {

/// First words of the text of a new config.
inline constexpr const char* kNewRigMark = "# Written by `flexarm config new`";

/// Values that a search found, by dotted key, as TOML, in place of the derived ones.
using TunedValues = std::map<std::string, std::string>;

/// A commented config of a rig with a simulated arm: what its owner told, what follows from it, and
/// for the rest the values of the thesis's rig. Each value has its source beside it.
/// @throws ConfigError if no rig follows from the description
std::string NewRigText(const ArmDescription& arm, const TunedValues& tuned = {});

/// The config that this text is.
RigConfig NewRig(const ArmDescription& arm, const TunedValues& tuned = {});

}  // namespace flexarm
