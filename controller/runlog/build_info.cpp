#include "controller/runlog/build_info.h"

#include "build_info_generated.h"

namespace flexarm {

const BuildInfo& ThisBuild() {
  static const BuildInfo info{.version = FLEXARM_VERSION,
                              .git_hash = FLEXARM_GIT_HASH,
                              .compiler = FLEXARM_COMPILER,
                              .flags_hash = FLEXARM_FLAGS_HASH};
  return info;
}

std::string BuildId() {
  const BuildInfo& build = ThisBuild();
  return build.git_hash + " " + build.compiler + " " + build.flags_hash;
}

std::string ProcessorOf(std::string_view build_id) {
  const std::string_view without_flags = build_id.substr(0, build_id.rfind(' '));
  return std::string(without_flags.substr(without_flags.rfind(' ') + 1));
}

}  // namespace flexarm
