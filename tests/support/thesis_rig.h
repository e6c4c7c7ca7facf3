#pragma once

#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// The thesis's Table 2 with its misprints corrected (E and rho, docs/theory/errata.md 3),
/// payload 0.1 kg.
///
/// With the digits used for golden.json, so that golden tests compare equal parameters.
inline ArmParameters ThesisRig() {
  constexpr double kE = 6.89e10, kRho = 2707.0;
  const BeamSection section1{.length_m = 0.8,
                             .area_m2 = 1.575e-4,
                             .second_moment_m4 = 2.657e-10,
                             .density_kg_m3 = kRho,
                             .youngs_modulus_pa = kE,
                             .half_thickness_m = 2.25e-3};
  const BeamSection section2{.length_m = 0.9,
                             .area_m2 = 9.525e-5,
                             .second_moment_m4 = 8.001e-11,
                             .density_kg_m3 = kRho,
                             .youngs_modulus_pa = kE,
                             .half_thickness_m = 1.5875e-3};
  ArmParameters p{};
  p.link[0] = {.section = {section1}, .damping_ratio = 0.03};
  p.link[1] = {.section = {section2}, .damping_ratio = 0.03};
  p.joint[0] = {.stiffness_nm_per_rad = 761.59,
                .rotor_inertia_kgm2 = 1.07e-2,
                .hub_inertia_kgm2 = 1.43e-7,
                .coulomb_friction_nm = 0.16,
                .viscous_friction_nm_s_per_rad = 0.0};
  p.joint[1] = {.stiffness_nm_per_rad = 497.96,
                .rotor_inertia_kgm2 = 9.25e-3,
                .hub_inertia_kgm2 = 1.05e-7,
                .coulomb_friction_nm = 0.01,
                .viscous_friction_nm_s_per_rad = 0.0};
  p.hub2_mass_kg = 0.24;
  p.motor2_mass_kg = 3.03;
  p.motor2_inertia_kgm2 = 1.15e-2;
  p.payload_mass_kg = 0.1;
  p.payload_inertia_kgm2 = 1.078e-7;
  p.shape_payload_mass_kg = 0.1;
  p.damping = DampingReading::kCurvatureRho;
  p.link1_tip_inertia = Link1TipInertia::kMotorAndRotor;
  return p;
}

}  // namespace flexarm
