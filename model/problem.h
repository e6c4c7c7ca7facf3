#pragma once

#include <string>

namespace flexarm {

/// One violated rule of a configuration. The `config` library adds file and line.
struct Problem {
  std::string key;    ///< full dotted key as in the TOML file, e.g. "joint1.stiffness_nm_per_rad"
  std::string value;  ///< the value found, as text
  std::string rule;   ///< the rule, and its reason
};

}  // namespace flexarm
