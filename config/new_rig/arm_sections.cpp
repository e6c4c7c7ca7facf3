#include <algorithm>
#include <array>
#include <cmath>

#include "config/new_rig/rig_sections.h"

namespace flexarm {
namespace {

constexpr const char* kGiven = "given";

std::string Of(std::size_t link, const char* key) {
  return "link" + std::to_string(link + 1) + "." + key;
}

std::string OfJoint(std::size_t joint, const char* key) {
  return "joint" + std::to_string(joint + 1) + "." + key;
}

/// A rectangle bent about its width.
struct CrossSection {
  double area_m2, second_moment_m4;
};

CrossSection SectionOf(const ArmDescription& arm, std::size_t link) {
  const double width_m = 1e-3 * arm.At(Of(link, "width_mm"));
  const double thickness_m = 1e-3 * arm.At(Of(link, "thickness_mm"));
  return {.area_m2 = width_m * thickness_m,
          .second_moment_m4 = width_m * std::pow(thickness_m, 3.0) / 12.0};
}

double BendingStiffness_nm2(const ArmDescription& arm, std::size_t link) {
  return arm.Or(Of(link, "bending_stiffness_nm2"),
                arm.material[link].youngs_modulus_pa * SectionOf(arm, link).second_moment_m4);
}

RigSection Masses(const ArmDescription& arm) {
  RigSection section{.header = "[arm]", .comment = {}, .lines = {}};
  const double elbow_kg = arm.At("elbow_mass_kg"), tip_kg = arm.At("tip_mass_kg");
  // That of the thesis's motor, of the same shape and density: radius with the cube root.
  const double inertia_kgm2 = 1.15e-2 * std::pow(elbow_kg / 3.03, 5.0 / 3.0);
  section.Add("hub2_mass_kg", 0.0, "in the next");
  section.Add("motor2_mass_kg", elbow_kg, "given: all that the end of link 1 carries");
  section.Add("motor2_inertia_kgm2", inertia_kgm2, "the thesis's motor, scaled to this mass");
  section.Add("payload_mass_kg", tip_kg, kGiven);
  section.Add("payload_inertia_kgm2", 1e-7, "a point");
  section.Add("shape_payload_mass_kg", tip_kg, "the nominal payload");
  section.Add("damping", "\"modal\"", "every mode of a link has its damping_ratio");
  section.Add("link1_tip_inertia", "\"motor_and_rotor\"");
  section.Add("foreshortening", "false");
  return section;
}

std::vector<RigSection> Link(const ArmDescription& arm, std::size_t link) {
  const std::string name = "link" + std::to_string(link + 1);
  RigSection damping{.header = "[" + name + "]", .comment = {}, .lines = {}};
  const bool told = arm.Has(Of(link, "damping_ratio"));
  damping.Add("damping_ratio", arm.Or(Of(link, "damping_ratio"), 0.01),
              told ? kGiven : "assumed: `flexarm identify` measures it");
  RigSection beam{.header = "[[" + name + ".section]]", .comment = {}, .lines = {}};
  const Material& material = arm.material[link];
  const std::string of = std::string(material.name) + ", " + material.what;
  beam.Add("length_m", arm.At(Of(link, "length_m")), kGiven);
  const CrossSection cross = SectionOf(arm, link);
  if (arm.Has(Of(link, "mass_per_length_kg_m")) || arm.Has(Of(link, "bending_stiffness_nm2"))) {
    beam.Add("mass_per_length_kg_m",
             arm.Or(Of(link, "mass_per_length_kg_m"), material.density_kg_m3 * cross.area_m2),
             arm.Has(Of(link, "mass_per_length_kg_m")) ? kGiven : of);
    beam.Add("bending_stiffness_nm2", BendingStiffness_nm2(arm, link),
             arm.Has(Of(link, "bending_stiffness_nm2")) ? kGiven : of);
  } else {
    const std::string size = TomlNumber(arm.At(Of(link, "width_mm"))) + " x " +
                             TomlNumber(arm.At(Of(link, "thickness_mm"))) + " mm";
    beam.Add("area_m2", cross.area_m2, size);
    beam.Add("second_moment_m4", cross.second_moment_m4, "width thickness^3 / 12");
    beam.Add("density_kg_m3", material.density_kg_m3, of);
    beam.Add("youngs_modulus_pa", material.youngs_modulus_pa, of);
  }
  beam.Add("half_thickness_m", 0.5e-3 * arm.At(Of(link, "thickness_mm")), "half the thickness");
  return {damping, beam};
}

RigSection Joint(const ArmDescription& arm, std::size_t joint) {
  const std::string name = "joint" + std::to_string(joint + 1);
  RigSection section{.header = "[" + name + "]", .comment = {}, .lines = {}};
  const auto has = [&](const char* key) { return arm.Has(OfJoint(joint, key)); };
  const double limit_nm = arm.At(OfJoint(joint, "torque_limit_nm"));
  const double gear = arm.Or(OfJoint(joint, "gear"), 1.0);
  const double rigid = 90.0 * BendingStiffness_nm2(arm, joint) / arm.At(Of(joint, "length_m"));
  const double rotor_kgm2 = has("motor_inertia_kgm2")
                                ? arm.At(OfJoint(joint, "motor_inertia_kgm2")) * gear * gear
                                : 5e-4 * limit_nm;
  section.Add("stiffness_nm_per_rad", arm.Or(OfJoint(joint, "stiffness_nm_per_rad"), rigid),
              has("stiffness_nm_per_rad") ? kGiven : "assumed: 90 EI / L, rigid beside the link");
  section.Add(
      "rotor_inertia_kgm2", rotor_kgm2,
      has("motor_inertia_kgm2") ? "given, times gear^2" : "assumed: 5e-4 kg m^2 per N m of torque");
  section.Add("hub_inertia_kgm2", 1e-3 * rotor_kgm2, "assumed: light beside the rotor");
  section.Add("coulomb_friction_nm", arm.Or(OfJoint(joint, "coulomb_friction_nm"), 4e-3 * limit_nm),
              has("coulomb_friction_nm")
                  ? kGiven
                  : "assumed: 0.4 % of the torque limit; `flexarm identify`");
  section.Add("viscous_friction_nm_s_per_rad", 0.0, "assumed");
  if (joint == 1) {
    section.Add("backlash_rad", 0.0, "assumed");
    section.Add("backlash_model", "\"dead_zone\"");
    section.Add("restitution_slope_s_per_rad", 0.0);
  }
  return section;
}

}  // namespace

std::vector<RigSection> ArmSections(const ArmDescription& arm) {
  std::vector<RigSection> sections = {Masses(arm)};
  for (std::size_t link = 0; link < 2; ++link) {
    for (RigSection& section : Link(arm, link)) sections.push_back(std::move(section));
  }
  for (std::size_t joint = 0; joint < 2; ++joint) sections.push_back(Joint(arm, joint));
  return sections;
}

}  // namespace flexarm
