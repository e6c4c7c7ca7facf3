#pragma once

#include <Eigen/Core>
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

inline RestMove MoveOf(const nlohmann::json& golden) {
  return {.from_rad = AsVector(golden["from_deg"]) * kRadPerDeg,
          .to_rad = AsVector(golden["to_deg"]) * kRadPerDeg,
          .payload_kg = golden["payload_kg"]};
}

}  // namespace flexarm
