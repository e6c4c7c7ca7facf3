#include "model/parameters/arm_parameters.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace flexarm {
namespace {

class Rules {
 public:
  void Require(bool ok, const std::string& key, double value, const char* rule) {
    if (ok && std::isfinite(value)) return;
    std::ostringstream text;
    text << value;
    problems_.push_back({key, text.str(), rule});
  }

  void CheckLink(const LinkParameters& link, const std::string& name) {
    Require(!link.section.empty(), name + ".section", static_cast<double>(link.section.size()),
            "a link needs at least one section");
    Require(link.damping_ratio >= 0.0 && link.damping_ratio < 1.0, name + ".damping_ratio",
            link.damping_ratio, "must lie in 0 <= xi < 1");
    for (std::size_t i = 0; i < link.section.size(); ++i) {
      CheckSection(link.section[i], name + ".section[" + std::to_string(i) + "]");
    }
  }

  void CheckJoint(const JointParameters& joint, const std::string& name) {
    Require(joint.stiffness_nm_per_rad > 0.0, name + ".stiffness_nm_per_rad",
            joint.stiffness_nm_per_rad, "must be positive");
    Require(joint.rotor_inertia_kgm2 > 0.0, name + ".rotor_inertia_kgm2", joint.rotor_inertia_kgm2,
            "must be positive: a rotor without inertia has no equation of motion");
    Require(joint.hub_inertia_kgm2 >= 0.0, name + ".hub_inertia_kgm2", joint.hub_inertia_kgm2,
            "must not be negative");
    Require(joint.coulomb_friction_nm >= 0.0, name + ".coulomb_friction_nm",
            joint.coulomb_friction_nm, "must not be negative");
    Require(joint.viscous_friction_nm_s_per_rad >= 0.0, name + ".viscous_friction_nm_s_per_rad",
            joint.viscous_friction_nm_s_per_rad, "must not be negative");
  }

  void CheckBacklash(const BacklashParameters& backlash) {
    Require(backlash.clearance_rad >= 0.0 && backlash.clearance_rad < 1.0, "joint2.backlash_rad",
            backlash.clearance_rad, "must lie in 0 <= d_b < 1 rad; 0: no backlash");
    Require(backlash.restitution_slope_s_per_rad >= 0.0, "joint2.restitution_slope_s_per_rad",
            backlash.restitution_slope_s_per_rad, "must not be negative");
  }

  // (3.8) as printed holds A, I and E apart from rho; rho A and EI do not give them.
  void CheckDamping(DampingReading reading, const std::array<LinkParameters, 2>& link) {
    if (reading != DampingReading::kCurvatureAsPrinted) return;
    if (link[0].has_cross_sections() && link[1].has_cross_sections()) return;
    problems_.push_back({"arm.damping", "\"ca_lit\"",
                         "needs area_m2, second_moment_m4, density_kg_m3 and youngs_modulus_pa of "
                         "every section; with mass_per_length_kg_m and bending_stiffness_nm2 there "
                         "are \"ca_rho\", \"modal\" and \"none\""});
  }

  void CheckNotNegative(const std::string& key, double value) {
    Require(value >= 0.0, key, value, "must not be negative");
  }

  std::vector<Problem> Take() { return std::move(problems_); }

 private:
  void CheckSection(const BeamSection& s, const std::string& name) {
    const auto positive = [&](const char* key, double value) {
      Require(value > 0.0, name + "." + key, value, "must be positive");
    };
    positive("length_m", s.length_m);
    if (s.has_cross_section) {
      positive("area_m2", s.area_m2);
      positive("second_moment_m4", s.second_moment_m4);
      positive("density_kg_m3", s.density_kg_m3);
      positive("youngs_modulus_pa", s.youngs_modulus_pa);
    } else {
      positive("mass_per_length_kg_m", s.given_mass_per_length_kg_m);
      positive("bending_stiffness_nm2", s.given_bending_stiffness_nm2);
    }
    positive("half_thickness_m", s.half_thickness_m);
  }

  std::vector<Problem> problems_;
};

}  // namespace

double LinkParameters::length_m() const {
  double sum = 0.0;
  for (const BeamSection& s : section) sum += s.length_m;
  return sum;
}

double LinkParameters::mass_kg() const {
  double sum = 0.0;
  for (const BeamSection& s : section) sum += s.mass_per_length_kg_m() * s.length_m;
  return sum;
}

double LinkParameters::HalfThicknessAt_m(double x_m) const {
  double end_m = 0.0;
  for (const BeamSection& part : section) {
    end_m += part.length_m;
    if (x_m <= end_m) return part.half_thickness_m;
  }
  return section.back().half_thickness_m;
}

bool LinkParameters::has_cross_sections() const {
  return std::all_of(section.begin(), section.end(),
                     [](const BeamSection& s) { return s.has_cross_section; });
}

std::vector<Problem> ArmParameters::Problems() const {
  Rules rules;
  rules.CheckLink(link[0], "link1");
  rules.CheckLink(link[1], "link2");
  rules.CheckJoint(joint[0], "joint1");
  rules.CheckJoint(joint[1], "joint2");
  rules.CheckBacklash(joint2_backlash);
  rules.CheckDamping(damping, link);
  rules.CheckNotNegative("arm.hub2_mass_kg", hub2_mass_kg);
  rules.CheckNotNegative("arm.motor2_mass_kg", motor2_mass_kg);
  rules.CheckNotNegative("arm.motor2_inertia_kgm2", motor2_inertia_kgm2);
  rules.CheckNotNegative("arm.payload_mass_kg", payload_mass_kg);
  rules.CheckNotNegative("arm.payload_inertia_kgm2", payload_inertia_kgm2);
  rules.CheckNotNegative("arm.shape_payload_mass_kg", shape_payload_mass_kg);
  return rules.Take();
}

}  // namespace flexarm
