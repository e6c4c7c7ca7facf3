#include "config/derivation/derivation.h"

#include "config/derivation/derivation_parts.h"

namespace flexarm {
namespace {

// Any arm: the keys do not depend on it.
TuningBasis SomeArm() {
  const BeamSection section{.length_m = 1.0,
                            .area_m2 = 1e-4,
                            .second_moment_m4 = 1e-10,
                            .density_kg_m3 = 2700.0,
                            .youngs_modulus_pa = 7e10,
                            .half_thickness_m = 1e-3};
  const JointParameters joint{.stiffness_nm_per_rad = 500.0,
                              .rotor_inertia_kgm2 = 0.01,
                              .hub_inertia_kgm2 = 0.0,
                              .coulomb_friction_nm = 0.1,
                              .viscous_friction_nm_s_per_rad = 0.0};
  TuningBasis basis{};
  basis.arm.link = {LinkParameters{.section = {section}, .damping_ratio = 0.01},
                    LinkParameters{.section = {section}, .damping_ratio = 0.01}};
  basis.arm.joint = {joint, joint};
  basis.arm.motor2_mass_kg = 1.0;
  basis.arm.motor2_inertia_kgm2 = 0.01;
  basis.arm.payload_mass_kg = basis.arm.shape_payload_mass_kg = 0.1;
  basis.sensors.encoder = {{.counter = 0, .counts_per_turn = 1e4, .counter_bits = 16, .sign = 1},
                           {.counter = 1, .counts_per_turn = 1e4, .counter_bits = 16, .sign = 1}};
  for (const int link : {1, 2}) {
    basis.sensors.strain.push_back(
        {.link = link, .position_m = 0.1, .face = 1, .gain_v_per_unit = 5e3, .offset_counts = 0.0});
  }
  basis.sensors.strain_input = {.converter_bits = 12,
                                .range_v = 10.0,
                                .filter_hz = 20.0,
                                .noise_counts = 1.0,
                                .filter_damping = 0.0};
  basis.period_s = 0.02;
  basis.torque_limit_nm = {10.0, 5.0};
  basis.strain_limit = {1e-3, 1e-3};
  basis.payload_range_kg = {0.0, 1.0};
  return basis;
}

}  // namespace

std::vector<DerivedValue> DeriveTuning(const TuningBasis& basis) {
  const ArmScales scales = ScalesOf(basis);
  DerivedList list;
  DeriveTiming(basis, &list);
  DeriveEstimator(basis, scales, &list);
  DerivePayloadFilter(basis, scales, &list);
  DeriveController(basis, scales, &list);
  DeriveLimits(basis, scales, &list);
  return list.Take();
}

std::vector<DerivedValue> DeriveSomeArm() { return DeriveTuning(SomeArm()); }

std::vector<std::string> DerivableKeys() {
  std::vector<std::string> keys;
  for (const DerivedValue& value : DeriveSomeArm()) keys.push_back(value.key);
  return keys;
}

}  // namespace flexarm
