#pragma once

#include <cmath>

#include "model/math/portable_math.h"

namespace flexarm {

/// PortableMath's functions from the C library: for off-line use, and for comparison.
struct LibraryMath {
  static SineCosine SinCos(double angle_rad) noexcept {
    return {std::sin(angle_rad), std::cos(angle_rad)};
  }
  static double Tanh(double x) noexcept { return std::tanh(x); }
};

}  // namespace flexarm
