#pragma once

#include <array>

namespace flexarm {

struct ControlConfig;

/// Limits of a reference, and the arm data for checking them. Index 0 is joint or link 1.
struct MotionLimits {
  std::array<double, 2> soft_angle_rad;  ///< |th|
  std::array<double, 2> torque_nm;       ///< at the gearbox output, friction included
  std::array<double, 2> slew_nm_per_s;   ///< of the torque, at the gate
  std::array<double, 2> hub_rate_rad_s;  ///< |th'|
  std::array<double, 2> strain;          ///< surface strain at the root of a link
  double plan_fraction;                  ///< share of them for moves without duration_s
  std::array<double, 2> fast_fraction;   ///< for the shortest moves, without payload and with the
                                         ///< largest; linear between
  double fast_least_s;                   ///< no shortest move is shorter
  std::array<double, 2> coulomb_friction_nm;
  std::array<double, 2> viscous_friction_nm_s_per_rad;
  int modes_per_link;                                      ///< of the reference model, 1 or 2
  std::array<std::array<double, 2>, 2> root_strain_per_m;  ///< strain per modal coordinate
  std::array<double, 2> link_length_m;                     ///< for positions of the tip
};

/// The limits of [limits] with the data of the arm. Start-up only: computes mode shapes.
/// @param reduced  those of WithReducedLimits
MotionLimits MotionLimitsOf(const ControlConfig& config, bool reduced = false);

}  // namespace flexarm
