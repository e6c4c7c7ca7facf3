#pragma once

#include <array>
#include <vector>

#include "controller/types/experiment.h"

namespace flexarm {

/// A CSV trajectory on the sampling grid: angles relative to where the reference rests, per joint.
///
/// A cubic spline through the rows, at rest at both ends, at every period from the first row to the
/// last; so it starts at 0. What the first row differs from `from_rad` is faded out on the way by a
/// quintic: the trajectory ends at its last row.
/// @param from_rad  th1, th2 at rest before it
/// @throws Refused if the first row is further than 1 deg from there, or the time of the last row
///         does not lie on the grid
std::array<std::vector<double>, 2> TrajectoryOnGrid(const CsvTrajectory& csv,
                                                    const std::array<double, 2>& from_rad,
                                                    double period_s);

}  // namespace flexarm
