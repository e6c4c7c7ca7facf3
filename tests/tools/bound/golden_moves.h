#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>

#include "config/config.h"
#include "model/units.h"
#include "tests/support/golden_data.h"
#include "tools/bound/bound_limits.h"
#include "tools/bound/rest_move.h"

namespace flexarm {

/// The thesis's rig, whose bounds golden/bounds.json has.
inline const RigConfig& BoundRig() {
  static const RigConfig config =
      LoadConfig(std::string(FLEXARM_SOURCE_DIR) + "/config/thesis-rig.toml");
  return config;
}

/// With the share of the drives' torques of golden/bounds.json.
inline BoundLimits GoldenLimits() { return BoundLimitsOf(BoundRig(), 14.0 / 15.0); }

/// The 30 moves of golden/bounds.json.
inline nlohmann::json GoldenMoves() {
  nlohmann::json moves = GoldenFile("bounds.json")["moves"];
  if (moves.size() != 30) throw std::runtime_error("bounds.json has not its 30 moves");
  return moves;
}

inline RestMove MoveOf(const nlohmann::json& golden) {
  return {.from_rad = AsVector(golden["from_deg"]) * kRadPerDeg,
          .to_rad = AsVector(golden["to_deg"]) * kRadPerDeg,
          .payload_kg = golden["payload_kg"]};
}

}  // namespace flexarm
