#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "controller/law/design.h"
#include "controller/law/experiment.h"
#include "controller/law/motion_limits.h"
#include "controller/law/rigid_point.h"

namespace flexarm {

/// A move with everything decided: on the grid, between joint angles.
struct PlannedMove {
  std::size_t row;                 ///< of [[move]]
  int first;                       ///< sample at which it begins
  int periods;                     ///< n; the profile itself takes n - 1, see ProfileAccelerations
  std::array<double, 2> from_rad;  ///< th1, th2
  std::array<double, 2> to_rad;
  MoveProfile profile;

  /// Y and its derivatives, `sample` periods after the experiment's start; analytic.
  /// Half a period behind the profile, as the reference model's rigid angles are. Real-time: safe.
  RigidPoint At(double sample, double period_s) const noexcept;
};

/// Samples between two rests of a path: one move, or several that took over from each other.
struct Stretch {
  int first;  ///< sample at which it begins
  int end;    ///< at which it rests again
};

/// @param moves  in order of time
std::vector<Stretch> StretchesOf(const std::vector<PlannedMove>& moves);

/// Decides the moves of an experiment that starts from rest at `start_rad`.
///
/// A position of the tip becomes angles of the straight arm. A move without duration gets the
/// shortest, in whole periods, whose reference keeps limits.plan_fraction of every limit.
/// @throws Refused naming the move that is off the grid, too short, out of reach, or has no
/// duration
///         that keeps the limits
std::vector<PlannedMove> PlanMoves(const Experiment& experiment, const Design& design,
                                   double period_s, const std::array<double, 2>& start_rad,
                                   const MotionLimits& limits);

/// u_m of a move per unit of ProfileAccelerations: M_r (to - from), N m s^2.
Eigen::Vector2d TorqueOf(const PlannedMove& move, const Design& design);

/// Where the reference rests just before `start_s`, with `moves` planned so far.
std::array<double, 2> PlaceBefore(const Experiment& experiment,
                                  const std::vector<PlannedMove>& moves,
                                  const std::array<double, 2>& start_rad, double start_s);

/// The fewest periods in which the move's reference keeps `share` of every limit; nothing if a
/// minute is not enough.
std::optional<int> ShortestPeriods(const PlannedMove& move, const Design& design, double period_s,
                                   const MotionLimits& limits, double share);

/// The experiment with the durations that were chosen, in the rows and in its text.
/// @throws Refused if rows overlap now, or do not end inside the experiment
Experiment WithChosenDurations(const Experiment& experiment, const std::vector<PlannedMove>& moves,
                               double period_s);

}  // namespace flexarm
