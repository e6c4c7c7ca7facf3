#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// One uniform section of a link. A link has any number of them, from root to tip.
///
/// Either its cross-section and its material are given, or, as publications often do, rho A and EI
/// alone; then A, I, rho and E are zero and nothing may use them.
struct BeamSection {
  double length_m;           ///< l > 0
  double area_m2;            ///< A > 0
  double second_moment_m4;   ///< I > 0, bending in the plane of motion
  double density_kg_m3;      ///< rho > 0 (Table 2: D)
  double youngs_modulus_pa;  ///< E > 0
  double half_thickness_m;   ///< h/2 > 0: distance of the gauges from the neutral line
  double given_mass_per_length_kg_m = 0.0;   ///< rho A > 0 without a cross-section; otherwise 0
  double given_bending_stiffness_nm2 = 0.0;  ///< EI > 0 without a cross-section; otherwise 0
  bool has_cross_section = true;             ///< A, I, rho and E are given, not rho A and EI

  double mass_per_length_kg_m() const {
    return has_cross_section ? density_kg_m3 * area_m2 : given_mass_per_length_kg_m;
  }
  double bending_stiffness_nm2() const {
    return has_cross_section ? youngs_modulus_pa * second_moment_m4 : given_bending_stiffness_nm2;
  }
};

/// Interpretation of the structural damping of a link (docs/theory/plant.md 5: the thesis's (3.8)
/// lacks rho).
enum class DampingReading : std::uint8_t {
  kNone,          ///< no structural damping
  kCurvatureRho,  ///< "ca_rho": C_a = xi L^2 sqrt(rho A E / I): (3.8) with its units corrected
  kCurvatureAsPrinted,  ///< "ca_lit": C_a = xi L^2 sqrt(A E / I), as printed
  kModal,               ///< "modal": every clamped mode of a link has the damping ratio xi
};

/// Rotary inertia at the tip of link 1 for which its mode shapes are computed.
enum class Link1TipInertia : std::uint8_t {
  kMotor,          ///< "motor": I_r2
  kMotorAndRotor,  ///< "motor_and_rotor": I_r2 + J2
};

struct LinkParameters {
  std::vector<BeamSection> section;  ///< root to tip, at least one
  double damping_ratio;              ///< xi, 0 <= xi < 1 (Table 2: ratio)

  double length_m() const;
  double mass_kg() const;
  bool has_cross_sections() const;  ///< of every section
  /// Half the thickness at `x_m` from the root; at a joint of two sections that of the inner one.
  double HalfThicknessAt_m(double x_m) const;
};

struct JointParameters {
  double stiffness_nm_per_rad;           ///< K > 0: spring between rotor and hub
  double rotor_inertia_kgm2;             ///< J > 0, at the gearbox output
  double hub_inertia_kgm2;               ///< I_h >= 0
  double coulomb_friction_nm;            ///< K_F >= 0, acts between hub and its base (3.12)
  double viscous_friction_nm_s_per_rad;  ///< >= 0, same place; not in the thesis
};

/// Model of the backlash between the gears of joint 2 (backlash.h).
enum class BacklashModel : std::uint8_t {
  kDeadZone,  ///< "dead_zone": no torque within the clearance, spring and impact loss at its ends
  kThesis,    ///< "thesis": the dissipation (3.9)-(3.11) on the rotor, errors included
};

struct BacklashParameters {
  BacklashModel model;
  double clearance_rad;                ///< d_b >= 0: free rotation, end to end; 0: no backlash
  double restitution_slope_s_per_rad;  ///< zeta >= 0: e = 1 - zeta |impact rate|
};

/// Physical constants of the arm, thesis Table 2 with readable names. SI units.
///
/// Joint 1 is the shoulder, joint 2 the elbow. Index 0 is link or joint 1.
struct ArmParameters {
  std::array<LinkParameters, 2> link;
  std::array<JointParameters, 2> joint;
  double hub2_mass_kg;          ///< M_h2 >= 0
  double motor2_mass_kg;        ///< M_r2 >= 0, carried by the end of link 1
  double motor2_inertia_kgm2;   ///< I_r2 >= 0, about the elbow, turns with the end of link 1
  double payload_mass_kg;       ///< m_p >= 0
  double payload_inertia_kgm2;  ///< I_p >= 0
  double
      shape_payload_mass_kg;  ///< payload for which the mode shapes are computed: the nominal one
  DampingReading damping;
  Link1TipInertia link1_tip_inertia;
  bool foreshortening;  ///< a bent link is shorter by 1/2 int w'^2: centrifugal stiffening
  BacklashParameters joint2_backlash;

  std::array<double, 2> joint_stiffness_nm_per_rad() const {
    return {joint[0].stiffness_nm_per_rad, joint[1].stiffness_nm_per_rad};
  }

  /// Every violated rule, keys relative to the config sections [link1] [link2] [joint1] [joint2]
  /// [arm]. Empty means that a model can be built.
  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
