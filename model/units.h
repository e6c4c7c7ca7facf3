#pragma once

#include <numbers>

namespace flexarm {

// Angles are in radians and frequencies in radians per second unless their name states another
// unit.
inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;  ///< rad per turn
inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// The same conversion, rounded once more: references and switches keep the bits that they had with
/// it.
constexpr double RadFromDeg(double deg) { return deg * kPi / 180.0; }

}  // namespace flexarm
