#pragma once

#include <cstdint>

#include "controller/host/simulation.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {

/// Random moves like those of MakeRandomMoves, but each as short as the law makes it: `duration =
/// "shortest"`, from the second on with `same_load`. A move begins three times the bound of the
/// slower end of the payload range after the one before it, and kRandomMovesRest_s later.
/// Source: docs/theory/fast-moves.md 5.
RandomMoves MakeFastMoves(const RigConfig& config, std::uint64_t seed, const MoveRecipe& recipe,
                          int moves = 4);

/// How long moves took over the shortest time of a rigid arm along the same straight line with the
/// plant's payload (RigidStraight_s), mean over the moves. NaN: one of them never came to rest, or
/// there is none.
struct BoundRatios {
  double first_at_rest, later_at_rest;      ///< Arrival::at_rest_s of the first, of the others
  double first_on_target, later_on_target;  ///< Arrival::on_target_s
};

/// @param request  all ratios are NaN unless its motions are moves `duration = "shortest"` to
///                 angles
BoundRatios RatiosOf(const SimulationRequest& request, const RunMetrics& metrics);

}  // namespace flexarm
