#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "tools/analysis/reduction_grid.h"

namespace flexarm {

/// Draws the pictures that correspond to figures 6.3 to 6.9 of the thesis into a folder, which is
/// created if it does not exist: contributions against the number of modes at the thesis's three
/// motions, and the first two modes' contribution over both rates at its four elbow angles.
/// @returns the files written
/// @throws std::runtime_error if gnuplot or the folder fails
std::vector<std::filesystem::path> DrawReductionFigures(const ArmModel& model,
                                                        const ReductionOptions& options,
                                                        const std::filesystem::path& folder);

/// Writes one row per cell, as CSV.
void WriteCells(const std::vector<ReductionCell>& cells, const std::filesystem::path& file);

}  // namespace flexarm
