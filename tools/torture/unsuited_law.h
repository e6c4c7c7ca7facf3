#pragma once

#include <string>

#include "config/config.h"
#include "tools/torture/scenario.h"
#include "tools/torture/torture.h"

namespace flexarm {

/// Why a law does not suit an arm: it trips without a fault in one of two moves, on one of the
/// plants of docs/sweep.md, with the least or the greatest payload of its sessions.
/// @returns trip, payload and plant, in one line; empty: it suits
std::string WhyUnsuited(const TorturedRigs& rigs, const TortureSpace& space,
                        const RigConfig& config, const std::string& law);

}  // namespace flexarm
