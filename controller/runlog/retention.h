#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "controller/types/runtime_config.h"

namespace flexarm {

/// Removes runs that are older than LogConfig::keep_days, then the oldest until all take less than
/// keep_total_mb. Only run logs that no process is writing are removed (by name and content), and
/// never the newest; each is a line of the journal, and so is each that cannot be removed.
/// Does nothing where neither key is set. Not real-time safe.
void RemoveOldRuns(const std::filesystem::path& directory, const LogConfig& config,
                   const std::function<void(bool is_error, const std::string& text)>& report);

}  // namespace flexarm
