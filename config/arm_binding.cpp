#include <algorithm>
#include <array>

#include "config/rig_sections.h"

namespace flexarm {
namespace {

// A section is given by its cross-section and its material, or by rho A and EI.
void ReadSection(TableReader row, BeamSection* out) {
  row.Read("length_m", &out->length_m, "length of the section; the lengths of a link add up");
  row.Read("half_thickness_m", &out->half_thickness_m,
           "distance of the gauges from the neutral line: half of the thickness in the plane of "
           "motion");
  constexpr std::array kCrossSection = {"area_m2", "second_moment_m4", "density_kg_m3",
                                        "youngs_modulus_pa"};
  constexpr const char* kMass = "mass_per_length_kg_m";
  constexpr const char* kStiffness = "bending_stiffness_nm2";
  const auto cross = std::count_if(kCrossSection.begin(), kCrossSection.end(),
                                   [&row](const char* key) { return row.Has(key); });
  const bool mass = row.Has(kMass), stiffness = row.Has(kStiffness);
  out->has_cross_section = cross > 0;
  if (cross > 0 && (mass || stiffness)) {
    row.Refuse(mass ? kMass : kStiffness,
               "must not be given beside area_m2, second_moment_m4, density_kg_m3 or "
               "youngs_modulus_pa: a section has its cross-section and material, or its mass per "
               "length and bending stiffness");
  } else if (cross == 0 && !mass && !stiffness) {
    row.Missing(kMass,
                "a number, beside bending_stiffness_nm2; or the section has area_m2, "
                "second_moment_m4, density_kg_m3 and youngs_modulus_pa");
    out->given_bending_stiffness_nm2 = 1.0;  // one message is enough
    return;
  }
  if (cross == 0) {
    row.Read(kMass, &out->given_mass_per_length_kg_m,
             "mass per length; with bending_stiffness_nm2 in place of the next four keys");
    row.Read(kStiffness, &out->given_bending_stiffness_nm2,
             "E I for bending in the plane of motion; with mass_per_length_kg_m");
    return;
  }
  row.Read("area_m2", &out->area_m2, "area of the cross-section");
  row.Read("second_moment_m4", &out->second_moment_m4,
           "second moment of area for bending in the plane of motion; of a strip b h^3 / 12");
  row.Read("density_kg_m3", &out->density_kg_m3, "density of the material");
  row.Read("youngs_modulus_pa", &out->youngs_modulus_pa, "modulus of elasticity of the material");
}

void ReadLink(TableReader link, LinkParameters* out) {
  link.Read("damping_ratio", &out->damping_ratio,
            {"damping of the bending; arm.damping says how it is meant", "1"});
  for (const TableReader& row :
       link.Rows("section",
                 "a piece of the link with one cross-section; rows from the root to the tip")) {
    ReadSection(row, &out->section.emplace_back());
  }
}

void ReadJoint(TableReader joint, JointParameters* out) {
  joint.Read("stiffness_nm_per_rad", &out->stiffness_nm_per_rad,
             "spring between rotor and hub: gear and shaft");
  joint.Read(
      "rotor_inertia_kgm2", &out->rotor_inertia_kgm2,
      "inertia of rotor and gear, at the gearbox output: motor's inertia times gear squared");
  joint.Read("hub_inertia_kgm2", &out->hub_inertia_kgm2, "inertia of the hub about its joint");
  joint.Read("coulomb_friction_nm", &out->coulomb_friction_nm,
             "Coulomb friction between hub and base, at the gearbox output");
  joint.Read("viscous_friction_nm_s_per_rad", &out->viscous_friction_nm_s_per_rad,
             "viscous friction, at the same place");
}

void ReadBacklash(TableReader joint2, BacklashParameters* out) {
  joint2.Read("backlash_model", &out->model,
              {{"dead_zone", BacklashModel::kDeadZone}, {"thesis", BacklashModel::kThesis}},
              "backlash of the simulated arm: \"dead_zone\" gives no torque within the clearance, "
              "\"thesis\" is the dissipation (3.9) to (3.11) as printed");
  joint2.Read("backlash_rad", &out->clearance_rad,
              "free rotation of the elbow's gears, end to end; 0: none");
  joint2.Read(
      "restitution_slope_s_per_rad", &out->restitution_slope_s_per_rad,
      "zeta of the restitution e = 1 - zeta v at an impact rate v; used with backlash only");
}

void ReadArmTable(TableReader arm, ArmParameters* out) {
  arm.Read("hub2_mass_kg", &out->hub2_mass_kg, "mass of the elbow's hub");
  arm.Read("motor2_mass_kg", &out->motor2_mass_kg,
           "mass of the elbow's motor, which the end of link 1 carries");
  arm.Read("motor2_inertia_kgm2", &out->motor2_inertia_kgm2,
           "inertia about the elbow of what turns with the end of link 1, motor housing");
  arm.Read("payload_mass_kg", &out->payload_mass_kg,
           "payload at the tip: that of the simulated arm and of the design");
  arm.Read("payload_inertia_kgm2", &out->payload_inertia_kgm2,
           "inertia of the payload about the tip");
  arm.Read("shape_payload_mass_kg", &out->shape_payload_mass_kg,
           "the nominal payload, for which the mode shapes are computed");
  arm.Read("foreshortening", &out->foreshortening,
           "true: a bent link is shorter along its hub's axis, which stiffens a fast arm; the "
           "thesis leaves it out");
  arm.Read("damping", &out->damping,
           {{"none", DampingReading::kNone},
            {"ca_rho", DampingReading::kCurvatureRho},
            {"ca_lit", DampingReading::kCurvatureAsPrinted},
            {"modal", DampingReading::kModal}},
           "damping of the links: \"ca_rho\" is (3.8) with the density that its units require, "
           "\"ca_lit\" is (3.8) as printed, with \"modal\" every clamped mode has damping_ratio");
  arm.Read(
      "link1_tip_inertia", &out->link1_tip_inertia,
      {{"motor", Link1TipInertia::kMotor}, {"motor_and_rotor", Link1TipInertia::kMotorAndRotor}},
      "inertia at the end of link 1 for its mode shapes: the elbow's motor without or with its "
      "rotor");
}

}  // namespace

void ReadArm(TableReader root, ArmParameters* out) {
  ReadLink(root.Table("link1", "the link from shoulder to elbow"), &out->link.front());
  ReadLink(root.Table("link2", "the link from elbow to tip"), &out->link.back());
  ReadJoint(root.Table("joint1", "the shoulder"), &out->joint.front());
  TableReader joint2 = root.Table("joint2", "the elbow");
  ReadJoint(joint2, &out->joint.back());
  ReadBacklash(joint2, &out->joint2_backlash);
  ReadArmTable(root.Table("arm", "masses, inertias and how the arm is modelled"), out);
}

}  // namespace flexarm
