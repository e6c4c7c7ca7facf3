#include "controller/host/daemon_identity.h"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "controller/runlog/build_info.h"
#include "controller/types/law_table.h"

namespace flexarm {

std::string ConfigHash(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  return fmt::format("{:016x}", hash);
}

nlohmann::json DaemonIdentity(const RigConfig& config, const std::string& config_file) {
  return {{"rig", config.rig_name},
          {"config",
           {{"file", std::filesystem::absolute(config_file).string()},
            {"hash", ConfigHash(config.text)}}},
          {"backend", config.backend},
          {"law", LawOf(config.controller.kind).name},
          {"period_ms", config.loop.period_ms},
          {"link_length_m", {config.arm.link[0].length_m(), config.arm.link[1].length_m()}},
          {"version", ThisBuild().version},
          {"build", BuildId()}};
}

}  // namespace flexarm
