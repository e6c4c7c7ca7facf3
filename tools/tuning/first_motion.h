#pragma once

#include <string>

#include "config/config.h"

namespace flexarm {

/// With this text begins every file that `flexarm config new` writes of a first motion.
inline constexpr const char* kFirstMotionMark = "# The first motion of a rig";

/// An experiment for the first motion of a rig, as TOML: each joint alone by a small angle, to both
/// sides of its zero and back, slowly.
///
/// The angle is 5 deg, or a quarter of the reduced soft angle if that is less. The moves take 4 s,
/// or as many times 1.5 longer as it takes until none of five payloads of
/// controller.payload_range_kg trips in simulation, with full and with reduced limits.
/// @throws RejectedError naming the trip if half a minute a move is not enough
std::string FirstMotion(const RigConfig& config);

}  // namespace flexarm
