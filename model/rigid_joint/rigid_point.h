#pragma once

#include <array>

namespace flexarm {

/// The rigid coordinate Y of both joints at one instant, and its derivatives. Plain bytes: the log
/// holds it.
///
/// Y = theta + M_tt^-1 M_tf f obeys M_tt Y'' + bias_t = u, because springs push on no hub: a smooth
/// Y asks for a smooth torque. With straight links it is theta.
struct RigidPoint {
  std::array<double, 2> angle_rad;            ///< Y
  std::array<double, 2> rate_rad_s;           ///< Y'
  std::array<double, 2> acceleration_rad_s2;  ///< Y''
  std::array<double, 2> jerk_rad_s3;          ///< Y'''
};

}  // namespace flexarm
