#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace flexarm {

/// On which side of the line from shoulder to tip the elbow lies, seen along it from above.
enum class ElbowSide : std::uint8_t {
  kLeft,   ///< th2 <= 0
  kRight,  ///< th2 >= 0
};

/// Inverse kinematics of the unbent arm: th1, th2 that place its tip at `tip_m`; empty if out of
/// reach.
///
/// Links straight, joints untwisted: the shape of the arm at rest.
/// Frame: base; th1 in -pi .. pi against its x axis, th2 against link 1, counter-clockwise.
/// @param length_m  L1, L2
/// @param tip_m     x, y; between |L1 - L2| and L1 + L2 from the shoulder
std::optional<std::array<double, 2>> StraightArmAngles(const std::array<double, 2>& length_m,
                                                       const std::array<double, 2>& tip_m,
                                                       ElbowSide elbow);

}  // namespace flexarm
