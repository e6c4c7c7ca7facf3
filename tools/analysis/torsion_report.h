#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// What the config of an arm does not state about its torsion, and where the elbow stands.
struct TorsionCase {
  double theta2_deg = 90.0;
  double poisson = 0.33;            ///< aluminium
  double payload_offset_mm = 10.0;  ///< of its centre from the axis of link 2, across the plane
  double motor_offset_mm = 0.0;     ///< of motor 2's centre from the axis of link 1
  double gravity_m_s2 = 9.81;       ///< across the plane of motion
};

/// A link as a shaft, assumed rectangular and solid.
struct LinkTorsion {
  double width_mm, thickness_mm;  ///< of its first section
  double torsion_constant_m4;     ///< of its first section
  double stiffness_nm_per_rad;    ///< over its whole length
  double free_hz;                 ///< clamped at the root, nothing at the tip
};

/// Torsion of the links, which no model here contains: how large is it?
struct TorsionEffect {
  TorsionCase of;
  std::array<LinkTorsion, 2> link;
  // Link 1 carries link 2, whose weight and inertia lie beside its axis unless the elbow is
  // straight.
  double carried_inertia_kgm2;  ///< about the axis of link 1
  double carried_hz;            ///< link 1's torsion with it
  double weight_nm;             ///< of link 2 and payload about that axis
  double twist_deg;             ///< of link 1, at rest
  double drop_by_twist_mm;      ///< of the tip
  double drop_by_bending_mm;    ///< of the elbow, across the plane
  /// Twist of link 1 per acceleration of the elbow in the plane, from the motor's offset.
  double twist_deg_per_m_s2;
  // Link 2 with its payload beside its axis.
  std::vector<double> bending_hz;  ///< payload on the axis: modes of bending alone
  std::vector<double> coupled_hz;  ///< payload beside it
  double first_shift_percent;      ///< of the lowest frequency
  double twist_deg_per_mm;         ///< in the lowest mode, by the tip's deflection
};

/// Why the torsion of a link cannot be told: a section without area and second moment, or whose
/// thickness by them is not that of half_thickness_m, to 10 %, so that it is no solid rectangle.
/// Empty: it can.
std::string LacksRectangles(const ArmParameters& arm);

/// @throws std::invalid_argument if Poisson's ratio is outside -1 .. 0.5, or with LacksRectangles
TorsionEffect TorsionOf(const ArmParameters& arm, const TorsionCase& of = {});

nlohmann::ordered_json TorsionJson(const TorsionEffect& effect);

}  // namespace flexarm
