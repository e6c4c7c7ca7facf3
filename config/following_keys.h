#pragma once

#include <string>
#include <vector>

#include "config/config.h"

namespace flexarm {

/// A line of a config with its value as TOML, before and after a change.
struct ChangedValue {
  std::string key;  ///< dotted, rows numbered: "link1.section[0].youngs_modulus_pa"
  std::string before, after;
  std::string how;  ///< why it changes
};

/// The keys that have in `before` the value that is derived from its arm, and another in the arm
/// of `after`: lines of `flexarm config new` that follow the arm. A value that was tuned or given
/// stays.
std::vector<ChangedValue> FollowingKeys(const RigConfig& before, const RigConfig& after);

/// A value of the config as TOML; the whole array of a key that names an element of one. "" if
/// there is none.
std::string ValueTextAt(const RigConfig& config, const std::string& key);

/// "arm.list[3]" without the index of its element: the key of the line. A key below a row is whole.
std::string LineKeyOf(const std::string& key);

}  // namespace flexarm
