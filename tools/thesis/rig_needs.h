#pragma once

#include <string>

#include "config/config.h"

namespace flexarm {

// What a statement needs of a config, which one of the thesis's arm may lack. Each returns what is
// missing, for NotForThisRig; empty: nothing.

/// Nominal models with two modes a link: gauges that measure them.
std::string LacksTwoModes(const RigConfig& config);

/// Statements about the nominal model R12: that it is the config's.
std::string LacksR12(const RigConfig& config);

}  // namespace flexarm
