#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/plot/plot_data.h"

namespace flexarm {

/// Draws closed-loop runs the way chapter 7 does: bending of both links, trajectory of both joints
/// with the reference, control effort. A curve a run.
/// @throws std::runtime_error if gnuplot fails
void DrawLoopRuns(const std::vector<PlotRun>& runs, const std::string& title,
                  const std::filesystem::path& output);

}  // namespace flexarm
