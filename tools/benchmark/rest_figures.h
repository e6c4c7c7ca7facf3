#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tools/sweep/sweep_row.h"

namespace flexarm {

/// How the tip came to rest in several runs. All but `settled_in_time` are over the completed runs;
/// NaN if none completed.
struct RestFigures {
  std::size_t settled_in_time = 0;   ///< completed runs that settled at most 0.3 s after every move
  double latest_settling_s = 0.0;    ///< infinite: a run has a rest that is not settled
  double target_error_max_mm = 0.0;  ///< farthest resting place from its target
  double residual_mean_mm = 0.0;     ///< over the last 0.3 s of the rests
  double residual_max_mm = 0.0;
  double motion_mean_mm = 0.0;  ///< from 0.3 s after the moves
  double motion_max_mm = 0.0;
  std::array<double, 2> rms_mean_deg{};  ///< of the joints, against the reference
  /// BoundRatios of the first move and of the later ones, mean over the runs that have them.
  std::array<double, 2> at_rest_over_bound{}, on_target_over_bound{};
  std::size_t at_rest = 0, on_target = 0;  ///< runs whose moves all came to rest, on target
};

RestFigures RestFiguresOf(const std::vector<SweepRow>& rows);

}  // namespace flexarm
