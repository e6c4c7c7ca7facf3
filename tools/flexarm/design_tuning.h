#pragma once

#include "config/config.h"

namespace flexarm {

/// Searches better noises and weights for a config (tools/tuning/tuning_search.h) and prints the
/// lines to change, or what is in the way. Writes nothing.
/// @returns an exit code: kDone if the tuned design passes every check
int TuneAndPrint(const RigConfig& config, bool json);

}  // namespace flexarm
