#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "config/following_keys.h"
#include "tools/identification/identification.h"

namespace flexarm {

/// A line of a config that an identification changes.
struct ChangedLine {
  ChangedValue value;
  std::string file;  ///< where the value stands; "": it is that of a run log, "--set": an override
  int line = 0;      ///< 0 without one
};

/// The config that the lines make: the identified values, rounded to what the run determines.
RigConfig WithFoundValues(const RigConfig& start, const Identification& found);

/// The identified lines, then those of the file that were derived from them, which follow the arm
/// (FollowingKeys): each in the order of the file.
/// @param file       of the config; empty: it is that of a run log
/// @param overrides  of the config, as for LoadConfig
std::vector<ChangedLine> ChangedLines(const RigConfig& start, const Identification& found,
                                      const std::filesystem::path& file,
                                      const std::vector<std::string>& overrides);

/// Two lines each: the place and the section, then the line as it is pasted, with its old value as
/// a comment.
std::string LinesText(const std::vector<ChangedLine>& lines);

/// [{"file", "line", "key", "before", "after", "how"}]; values as TOML.
nlohmann::ordered_json LinesJson(const std::vector<ChangedLine>& lines);

}  // namespace flexarm
