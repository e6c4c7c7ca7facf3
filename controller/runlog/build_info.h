#pragma once

#include <string>
#include <string_view>

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

/// The processor in a BuildId: "x86_64", "aarch64".
std::string ProcessorOf(std::string_view build_id);

}  // namespace flexarm
