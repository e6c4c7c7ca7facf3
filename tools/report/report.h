#pragma once

#include <filesystem>

#include "config/config.h"

namespace flexarm {

/// Inputs of a report.
struct ReportRequest {
  RigConfig config;                   ///< of the rig, with the simulated backend's section
  std::filesystem::path experiments;  ///< folder of the benchmark's commands
  std::filesystem::path published;    ///< file of the published cases; may be missing
  std::filesystem::path folder;       ///< new or empty
};

/// Recomputes every figure and table of chapters 4 to 7, compares them with the statements of the
/// thesis, runs the benchmark of the laws, and compares the model with published arms. Writes
/// report.html, which needs no other file, and the data behind it in figures/, tables/ and runs/.
/// Shows progress bars on a terminal.
/// @returns the page
/// @throws InputError  the folder is not empty; Refused  the rig has no controller
std::filesystem::path WriteReport(const ReportRequest& request);

}  // namespace flexarm
