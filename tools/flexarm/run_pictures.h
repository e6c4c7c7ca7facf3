#pragma once

#include <filesystem>
#include <vector>

#include "tools/command_line/options.h"

namespace flexarm {

/// Pictures of runs, laid over each other: -o FILE.png or .svg, and --html FILE.html.
struct RunPictures {
  OutputOptions picture;
  std::filesystem::path page;  ///< empty: none

  /// @param runs  logs that may not be overwritten
  /// @throws InputError unless there is something to write, and it may be written
  void Check(const std::vector<std::filesystem::path>& runs) const;

  /// @throws InputError  as Check, or a log has no ticks
  void Draw(const std::vector<std::filesystem::path>& runs) const;
};

}  // namespace flexarm
