#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/plot/plot_data.h"

namespace flexarm {

/// Draws closed-loop runs like the figures of chapter 7: bending of both links, trajectory of both
/// joints with the reference, control effort. One curve per run.
/// @throws std::runtime_error if gnuplot fails
void DrawLoopRuns(const std::vector<PlotRun>& runs, const std::string& title,
                  const std::filesystem::path& output);

}  // namespace flexarm
