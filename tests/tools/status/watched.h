#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/status/watch_screen.h"

namespace flexarm {

inline std::filesystem::path WatchGolden(const std::string& file) {
  return std::filesystem::path(FLEXARM_SOURCE_DIR) / "tests/golden/watch" / file;
}

/// A status of a simulated arm that carries out square-30deg.toml, with the buses of a wired rig.
/// Its figures are made up: large enough that each bar shows something.
inline Reply RunningStatus() {
  std::ifstream file(WatchGolden("running.json"));
  return Reply::parse(file);
}

inline WatchedStatus Watched(Reply status) {
  return {.status = std::move(status), .age_s = 0.1, .no_answer = ""};
}

inline constexpr ScreenStyle kPlainUtf8{.colour = false, .utf8 = true};

inline std::string Joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace flexarm
