#pragma once

#include <sstream>
#include <vector>

#include "tools/plot/plot_data.h"
#include "tools/plot/sheet.h"
#include "tools/plot/time_axis.h"

namespace flexarm {

/// The right column of a picture of runs: the arm from above in the moves, in a grid with equal
/// scales; below, the figures of the runs and what the marks on the time axis stand for.
/// @param top_px  of the column
void WriteArmViews(const std::vector<PlotRun>& runs, const TimeAxis& axis, const Sheet& sheet,
                   double top_px, std::ostringstream* script);

}  // namespace flexarm
