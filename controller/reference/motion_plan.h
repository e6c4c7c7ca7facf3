#pragma once

#include <array>
#include <stop_token>
#include <string>
#include <vector>

#include "controller/law/design.h"
#include "controller/reference/motion_limits.h"
#include "controller/reference/planned_move.h"
#include "controller/types/experiment.h"

namespace flexarm {

/// Samples between two rests of a path: one move, or several that retarget each other.
struct MotionSegment {
  int first;  ///< sample at which it begins
  int end;    ///< at which the path is at rest again
};

/// @param moves  in order of time
std::vector<MotionSegment> MotionSegmentsOf(const std::vector<PlannedMove>& moves);

/// Motion planner: fixes all moves of an experiment that starts from rest at `start_rad`.
///
/// A position of the tip becomes joint angles of the straight arm. A move that begins before the
/// one above it ends retargets, if the law follows a path. A move without duration gets the
/// shortest one, in whole periods, whose reference keeps limits.plan_fraction of every limit.
/// @throws RejectedError naming the move that is off the grid, too short, out of reach, begins
///         while the one above it lasts, or has no duration that keeps the limits; or that a stop
///         was requested, which is looked at before each move
std::vector<PlannedMove> PlanMoves(const Experiment& experiment, const Design& design,
                                   double period_s, const std::array<double, 2>& start_rad,
                                   const MotionLimits& limits, const std::stop_token& stop = {});

/// Periods of a move whose duration is given.
/// @param key  its name in messages
/// @throws RejectedError if it is not on the grid, or too short
int GivenPeriods(double duration_s, double period_s, const std::string& key);

/// Joint angles at the end of a move, rad: its to_deg, or those of the straight arm with the tip at
/// to_tip_m.
/// @param row  name of the move in messages
/// @throws RejectedError if they are out of reach, or two poses are possible
std::array<double, 2> GoalOf(const Move& move, const std::string& row, const MotionLimits& limits);

/// Joint angles of the reference at rest just before `start_s`, with the `moves` planned so far.
std::array<double, 2> PlaceBefore(const Experiment& experiment,
                                  const std::vector<PlannedMove>& moves,
                                  const std::array<double, 2>& start_rad, double start_s);

/// The experiment with the chosen durations, in its rows and in its text.
/// @throws RejectedError if a move now overlaps a row of another kind, or ends after the experiment
Experiment WithChosenDurations(const Experiment& experiment, const std::vector<PlannedMove>& moves,
                               double period_s);

}  // namespace flexarm
