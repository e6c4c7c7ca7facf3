#pragma once

#include <array>
#include <vector>

#include "controller/reference/path_time.h"
#include "controller/reference/planned_move.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// The path of a run as moves in path time (PathTime), and the progress along it.
struct PathPlan {
  std::vector<PlannedMove> moves;   ///< in order of path time; samples are periods of it
  std::array<double, 2> start_rad;  ///< at rest, before the first move
  double end;                       ///< path time at which the run ends
  PathTime time;

  /// Y after `periods` of path time, with derivatives over path time, 1/s.
  RigidPoint AtPathTime(double periods, double period_s) const noexcept;

  /// Y at a sample of the run, with derivatives over time. @pre as PathTime::At
  RigidPoint At(int sample, double period_s) const noexcept;

  /// The first sample, not before `from`, that is so far along the path; INT_MAX: none.
  int FirstSampleAt(double periods, int from) const noexcept;
};

}  // namespace flexarm
