#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "controller/types/rig_config.h"

namespace flexarm {

/// Of the whole text of a config, with what it extends and with --set: equal configs have equal
/// ones. FNV-1a, 16 digits.
std::string ConfigHash(std::string_view text);

/// Which rig, config and program a daemon is, for its status, and what of the config a reader of
/// the status needs: {"rig", "config": {"file", "hash"}, "backend", "law", "period_ms",
/// "link_length_m", "link_tip_slope_per_m", "limits", "version", "build"} (docs/protocol.md).
/// @param config_file  as it was given; "hash" is its ConfigHash
nlohmann::json DaemonIdentity(const RigConfig& config, const std::string& config_file);

}  // namespace flexarm
