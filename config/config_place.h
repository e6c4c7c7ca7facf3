#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flexarm {

/// Where a value stands; file and line as in ConfigProblem.
struct ConfigPlace {
  std::string file;
  int line;
};

/// The places of dotted keys in a config that LoadConfig has read with the same arguments.
std::vector<ConfigPlace> PlacesOf(const std::filesystem::path& file,
                                  const std::vector<std::string>& overrides,
                                  const std::vector<std::string>& keys);

}  // namespace flexarm
