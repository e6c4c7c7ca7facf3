#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "controller/runlog/run_list.h"

namespace flexarm {

/// A key of a config whose value differs.
struct ConfigChange {
  std::string key;            ///< dotted, rows numbered from 0: "sensors.strain[3].position_m"
  std::string before, after;  ///< as TOML; "": the config has no such key
};

/// All keys in which two configs differ, as texts of run logs (RigConfig::text), in the order of
/// their names. @throws ConfigError if one is no TOML
std::vector<ConfigChange> ConfigChanges(const std::string& before, const std::string& after);

/// A run that ended as its experiment ends.
struct GoodRun {
  std::filesystem::path file;
  RunHead head;
};

/// The newest good run of the same rig that began before `log`, in its folder; empty: there is
/// none among the newest kMostLooked logs before it, or none can be read.
inline constexpr std::size_t kMostLooked = 200;
std::optional<GoodRun> GoodRunBefore(const std::filesystem::path& log, const RunInfo& info);

}  // namespace flexarm
