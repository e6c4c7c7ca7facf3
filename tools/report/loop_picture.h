#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/plot/plot_data.h"

namespace flexarm {

/// What one figure of chapter 7 shows of both links or joints.
enum class LoopView { kBending, kTrajectory, kEffort };

/// "Bending motion", "Joint trajectory", "Control effort", as in the thesis's captions.
const char* TitleOf(LoopView view);

/// Draws closed-loop runs like a figure of chapter 7, over the 6 s of an experiment: bending, joint
/// angle with the reference (dashed), or torque of both. One curve per run, their names beside the
/// curves.
/// @throws std::runtime_error if gnuplot fails
void DrawLoopRuns(const std::vector<PlotRun>& runs, LoopView view,
                  const std::filesystem::path& output);

}  // namespace flexarm
