#pragma once

#include <numbers>

namespace flexarm {

/// One degree, in radians.
inline constexpr double kDeg = std::numbers::pi / 180.0;

}  // namespace flexarm
