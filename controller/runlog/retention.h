#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "controller/types/runtime_config.h"

namespace flexarm {

/// Removes runs that are older than LogConfig::keep_days, then the oldest until all take less than
/// keep_total_mb. Only closed runs are removed, and never the newest; each is a line of the
/// journal, and so is each that cannot be removed. What is being written or was left by a killed
/// program stays, and what this version cannot read: how it ended is not known. So does the log of
/// a trip, unless keep_trips is false. What stays counts, and the next oldest goes in its place.
/// The trip reports beside a log count with it, and go with it. Does nothing where neither key is
/// set. Not real-time safe.
void RemoveOldRuns(const std::filesystem::path& directory, const LogConfig& config,
                   const std::function<void(bool is_error, const std::string& text)>& report);

}  // namespace flexarm
