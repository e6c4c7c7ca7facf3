#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/plot/plot_data.h"

namespace flexarm {

/// A gnuplot script, data included, that draws runs into `output` (.png or .svg): joint angles,
/// torques, deflections, the tip's distance from rest, the safety state, and the arm from above.
std::string PlotScript(const std::vector<PlotRun>& runs, const std::filesystem::path& output);

}  // namespace flexarm
