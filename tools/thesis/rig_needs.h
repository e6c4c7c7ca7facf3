#pragma once

#include <string>

#include "config/config.h"

namespace flexarm {

// What a statement needs of a rig, which a rig other than the thesis's may lack. Each returns what
// is missing, for NotForThisRig; empty: nothing.

/// Statements about the numbers of 4.2.1 and Table 2: links of their lengths.
std::string LacksThesisLinks(const ArmParameters& arm);

/// Nominal models with two modes a link: gauges that measure them.
std::string LacksTwoModes(const RigConfig& config);

/// Statements about the nominal model R12: that it is the config's.
std::string LacksR12(const RigConfig& config);

}  // namespace flexarm
