#pragma once

#include <array>

namespace flexarm {

/// The rigid coordinate Y of both joints at one instant, and its derivatives. Trivially copyable:
/// it is logged as bytes.
///
/// Y = theta + M_tt^-1 M_tf f satisfies M_tt Y'' + bias_t = u, because no spring acts on a hub: a
/// smooth Y needs a smooth torque. With straight links it is theta.
struct RigidPoint {
  std::array<double, 2> angle_rad;            ///< Y
  std::array<double, 2> rate_rad_s;           ///< Y'
  std::array<double, 2> acceleration_rad_s2;  ///< Y''
  std::array<double, 2> jerk_rad_s3;          ///< Y'''
};

}  // namespace flexarm
