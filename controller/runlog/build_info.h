#pragma once

#include <string>

namespace flexarm {

/// Identity of this build. Two builds with the same id compute the same bytes.
struct BuildInfo {
  std::string version;     ///< of the project, from CMakeLists.txt
  std::string git_hash;    ///< 12 digits, "-dirty" when the tree had changes; "unknown" without git
  std::string compiler;    ///< "GNU 12.2.0 x86_64"
  std::string flags_hash;  ///< of build type and compiler flags
};

const BuildInfo& ThisBuild();

/// "<git hash> <compiler> <flags hash>": logged, and compared by replay.
std::string BuildId();

}  // namespace flexarm
