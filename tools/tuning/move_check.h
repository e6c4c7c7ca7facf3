#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "config/config.h"

namespace flexarm {

/// What became of moves to random places.
struct MoveCheck {
  bool passed;
  std::string problem;      ///< "trip hub-rate-2 with 0.3 kg"; "" if it passed
  double largest_error_mm;  ///< distance of the tip from the target, at the end of a move
  double permitted_mm;
};

/// Simulates four moves to places drawn from each seed, without duration, for each payload, and
/// looks at the distance of the tip from each target at the end of its rest.
///
/// Permitted is the smaller of 15 mm and 1 % of the reach, plus one count of a hub's encoder at the
/// tip. Ends at the first problem.
/// @param share  of the permitted distance that passes
MoveCheck CheckMoves(const RigConfig& config, const std::vector<double>& payload_kg,
                     std::span<const std::uint64_t> seeds, double share);

/// Simulates random moves `duration = "shortest"` (MakeFastMoves) of each seed with each payload.
/// @returns "" if no run trips and every move comes to rest, else the first problem
std::string ProblemOfFastMoves(const RigConfig& config, const std::vector<double>& payload_kg,
                               std::span<const std::uint64_t> seeds);

}  // namespace flexarm
