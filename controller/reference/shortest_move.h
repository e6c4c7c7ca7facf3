#pragma once

#include <array>
#include <optional>
#include <span>

#include "controller/law/design.h"
#include "controller/reference/motion_limits.h"
#include "controller/reference/planned_move.h"

namespace flexarm {

inline constexpr int kFewestPeriods = 10;  ///< of a move: with fewer the profile is not smooth
inline constexpr double kLongestChosen_s = 60.0;  ///< end of the search

/// Minimum-time planning: the fewest periods in which the last of `moves` keeps `share` of every
/// limit; nothing if a minute is not enough. The `periods` of the last move are ignored.
///
/// From rest a longer move has smaller peaks, so bisection finds the shortest. A move that
/// retargets can also be too long, as the arm goes on farther before it turns round: all durations
/// are tried, from the shortest.
/// @param moves  in order of time, not empty; those before the last define what it replaces
std::optional<int> ShortestPeriods(std::span<const PlannedMove> moves, const Design& design,
                                   double period_s, const MotionLimits& limits, double share);

/// The same of a move that retargets, by the path before it alone.
/// @param before  the path two samples and one before it begins
/// @param move    its `first` and `periods` are ignored
std::optional<int> ShortestRetarget(const std::array<RigidPoint, 2>& before,
                                    const PlannedMove& move, const Design& design, double period_s,
                                    const MotionLimits& limits, double share);

/// The fewest periods of a move from rest with each payload, for a law that follows a path: with
/// limits.fast_fraction of the torque and strain limits, 0.8 / 0.72 of that of the rate limits, and
/// at least limits.fast_least_s. Nothing if a minute is not enough for some payload.
/// Source: docs/theory/fast-moves.md 1.
std::optional<DurationTable> ShortestByPayload(const PlannedMove& move, const Design& design,
                                               double period_s, const MotionLimits& limits);

}  // namespace flexarm
