#pragma once

#include <array>
#include <vector>

#include "controller/types/experiment.h"

namespace flexarm {

/// Samples a CSV trajectory on the grid: angles relative to the rest position before it, per joint.
///
/// A cubic spline through the rows, at rest at both ends, sampled every period from the first row
/// to the last; so it starts at 0. A difference of the first row from `from_rad` is faded out by a
/// quintic: the trajectory ends at its last row.
/// @param from_rad  th1, th2 at rest before it
/// @throws RejectedError if the first row is further than 1 deg from there, or the time of the last
/// row
///         does not lie on the grid
std::array<std::vector<double>, 2> TrajectoryOnGrid(const CsvTrajectory& csv,
                                                    const std::array<double, 2>& from_rad,
                                                    double period_s);

}  // namespace flexarm
