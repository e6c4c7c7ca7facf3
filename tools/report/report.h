#pragma once

#include <filesystem>
#include <string>

#include "config/config.h"

namespace flexarm {

/// Inputs of a report.
struct ReportRequest {
  RigConfig config;                   ///< of the rig, with the simulated backend's section
  Experiment experiment;              ///< that the overview shows a run of
  std::filesystem::path experiments;  ///< folder of the benchmark's commands
  std::filesystem::path published;    ///< file of the published cases; may be missing
  std::filesystem::path folder;       ///< new or empty
  std::string laws;                   ///< of the benchmark, with commas between; empty: all
  int runs = 5;                       ///< of random moves for each law and scenario
};

/// Describes the arm, runs the config's law and the benchmark of the laws. For the thesis's arm
/// (IsThesisArm) also recomputes every figure and table of chapters 4 to 7, compares them with the
/// statements of the thesis, and compares the model with published arms. Writes report.html, which
/// needs no other file, and the data behind it in figures/, tables/ and runs/. Shows progress bars
/// on a terminal.
/// @returns the page
/// @throws InputError  the folder is not empty; Refused  the rig has no controller
std::filesystem::path WriteReport(const ReportRequest& request);

}  // namespace flexarm
