#pragma once

#include <array>

namespace flexarm {

/// The rigid coordinate Y of both joints at one instant.
struct RigidPoint {
  std::array<double, 2> angle_rad;            ///< Y
  std::array<double, 2> rate_rad_s;           ///< Y'
  std::array<double, 2> acceleration_rad_s2;  ///< Y''
  std::array<double, 2> jerk_rad_s3;          ///< Y'''
};

}  // namespace flexarm
