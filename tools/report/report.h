#pragma once

#include <filesystem>

#include "config/config.h"

namespace flexarm {

/// What a report is made of.
struct ReportRequest {
  RigConfig config;                   ///< of the rig, with the simulated backend's section
  std::filesystem::path experiments;  ///< folder of the benchmark's commands
  std::filesystem::path folder;       ///< new or empty
};

/// Recomputes every figure and table of chapters 4 to 7, with what the thesis says beside it, and
/// the benchmark of the laws. Writes report.html, which needs no other file, and beside it
/// figures/, tables/ and runs/, the material. Progress bars on a terminal.
/// @returns the page
/// @throws InputError  the folder is not empty; Refused  the rig has no controller
std::filesystem::path WriteReport(const ReportRequest& request);

}  // namespace flexarm
