#pragma once

#include <string>
#include <utility>
#include <vector>

#include "config/new_rig/arm_description.h"

namespace flexarm {

/// One line `key = value  # source` of a section.
struct RigLine {
  std::string key, value, source;
};

/// A section of a config, or a row of a list of sections.
struct RigSection {
  std::string header;   ///< "[arm]" or "[[sensors.strain]]"
  std::string comment;  ///< above the header; may be empty
  std::vector<RigLine> lines;

  void Add(std::string key, std::string value, std::string source = {}) {
    lines.push_back({std::move(key), std::move(value), std::move(source)});
  }
  void Add(std::string key, double value, std::string source = {});
};

/// TOML text of a number with at most six significant digits.
std::string TomlNumber(double value);

// Every section of the config but the derivable keys.
std::vector<RigSection> ArmSections(const ArmDescription& arm);
std::vector<RigSection> SensorSections(const ArmDescription& arm);
std::vector<RigSection> LoopSections(const ArmDescription& arm);

}  // namespace flexarm
