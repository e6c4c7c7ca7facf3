#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flexarm {

/// One value of a config, with where it comes from.
struct ShownValue {
  std::string key;     ///< dotted, rows numbered: "sensors.strain[3].position_m"
  std::string value;   ///< as TOML
  std::string origin;  ///< "thesis-rig.toml:14", "--set", or "derived: 2 % of .."
  std::string file;    ///< of the value; "" if it was derived
  int line;            ///< 0 without one
};

/// Every value of the config that LoadConfig reads from the same arguments, in alphabetical order
/// of the keys.
std::vector<ShownValue> ShownConfig(const std::filesystem::path& file,
                                    const std::vector<std::string>& overrides);

}  // namespace flexarm
