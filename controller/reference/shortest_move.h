#pragma once

#include <optional>
#include <span>

#include "controller/law/design.h"
#include "controller/reference/motion_limits.h"
#include "controller/reference/planned_move.h"

namespace flexarm {

inline constexpr int kFewestPeriods = 10;         ///< of a move: fewer are no smooth profile
inline constexpr double kLongestChosen_s = 60.0;  ///< no longer one is looked for

/// The fewest periods in which the last of `moves` keeps `share` of every limit; nothing if a
/// minute is not enough. What its own `periods` are does not matter.
///
/// From rest a longer move is a gentler one, and halving finds it. One that takes over an arm
/// that moves can also be too long, as it goes on farther before it turns round: all durations are
/// tried, from the shortest.
/// @param moves  in order of time, not empty; those before the last say what that takes over
std::optional<int> ShortestPeriods(std::span<const PlannedMove> moves, const Design& design,
                                   double period_s, const MotionLimits& limits, double share);

}  // namespace flexarm
