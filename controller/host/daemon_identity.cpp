#include "controller/host/daemon_identity.h"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "controller/runlog/build_info.h"
#include "controller/types/law_table.h"
#include "model/beam/link_modes.h"

namespace flexarm {

std::string ConfigHash(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  return fmt::format("{:016x}", hash);
}

namespace {

// Of the shapes by which modal coordinates are meant: those of modal_m of the status.
nlohmann::json TipSlopes(const LinkModes& link) { return {link.slope_tip(0), link.slope_tip(1)}; }

}  // namespace

nlohmann::json DaemonIdentity(const RigConfig& config, const std::string& config_file) {
  return {{"rig", config.rig_name},
          {"config",
           {{"file", std::filesystem::absolute(config_file).string()},
            {"hash", ConfigHash(config.text)}}},
          {"backend", config.backend},
          {"law", LawOf(config.controller.kind).name},
          {"period_ms", config.loop.period_ms},
          {"link_length_m", {config.arm.link[0].length_m(), config.arm.link[1].length_m()}},
          {"link_tip_slope_per_m",
           {TipSlopes(Link1Modes(config.arm, 2)), TipSlopes(Link2Modes(config.arm, 2))}},
          {"version", ThisBuild().version},
          {"build", BuildId()}};
}

}  // namespace flexarm
