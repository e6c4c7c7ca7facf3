#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/plot/plot_data.h"

namespace flexarm {

/// A gnuplot script, data included, that draws runs into `output` (.png or .svg): joint angles,
/// torques and root strains with their limits, deflections, the tip's distance from its target, the
/// payload where the law estimates it, the safety state, events, and the arm from above. For any
/// number of moves and any duration.
std::string PlotScript(const std::vector<PlotRun>& runs, const std::filesystem::path& output);

}  // namespace flexarm
