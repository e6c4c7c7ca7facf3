#pragma once

#include <string>
#include <vector>

#include "controller/types/rig_config.h"

namespace flexarm {

/// A value that is allowed and that hardly any arm has: often a wrong unit or a slipped decimal
/// point. A warning, never an error: the arm of a research project may be unusual.
struct ImplausibleValue {
  std::string key;      ///< full dotted key, e.g. "link1.section[0].youngs_modulus_pa"
  std::string value;    ///< the value found, as text
  std::string unusual;  ///< what is unusual about it
  std::string usual;    ///< what would be usual
};

/// Every value of a valid config that a rule of plausibility_rules.h finds implausible. An arm
/// without natural frequencies is judged by its numbers alone.
std::vector<ImplausibleValue> ImplausibleValues(const RigConfig& config);

}  // namespace flexarm
