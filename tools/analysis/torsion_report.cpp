#include "tools/analysis/torsion_report.h"

#include <cmath>
#include <stdexcept>

#include "model/beam/link_modes.h"
#include "model/beam_methods/link_torsion.h"
#include "model/units.h"
#include "tools/analysis/statement.h"

namespace flexarm {
namespace {

constexpr int kTorsionModes = 4;  // of link 2, bending and twisting
constexpr double kMm = 1e-3;

LinkTorsion AsShaft(const LinkParameters& link, const TwistingLink& shaft) {
  const RectangularSection shape(link.section.front());
  return {.width_mm = shape.width_m / kMm,
          .thickness_mm = shape.thickness_m / kMm,
          .torsion_constant_m4 = shape.TorsionConstant_m4(),
          .stiffness_nm_per_rad = shaft.Stiffness_nm_per_rad(),
          .free_hz = shaft.TorsionHz(0.0)};
}

void AddLink1(const ArmParameters& arm, const TwistingLink& shaft, TorsionEffect* effect) {
  const TorsionCase& of = effect->of;
  const LinkParameters& link2 = arm.link[1];
  const double L2 = link2.length_m(), s = std::sin(of.theta2_deg * kRadPerDeg);
  double first_kgm = arm.payload_mass_kg * L2, second_kgm2 = arm.payload_mass_kg * L2 * L2, x = 0.0;
  for (const BeamSection& section : link2.section) {
    const double to = x + section.length_m, mass_per_m = section.mass_per_length_kg_m();
    first_kgm += mass_per_m * (to * to - x * x) / 2.0;
    second_kgm2 += mass_per_m * (to * to * to - x * x * x) / 3.0;
    x = to;
  }
  const double e = of.motor_offset_mm * kMm, elbow_kg = arm.motor2_mass_kg + arm.hub2_mass_kg;
  const double stiffness = shaft.Stiffness_nm_per_rad();
  effect->carried_inertia_kgm2 = s * s * second_kgm2 + arm.motor2_mass_kg * e * e;
  effect->carried_hz = shaft.TorsionHz(effect->carried_inertia_kgm2);
  effect->weight_nm = of.gravity_m_s2 * std::abs(s) * first_kgm;
  const double twist_rad = effect->weight_nm / stiffness;
  effect->twist_deg = twist_rad / kRadPerDeg;
  effect->drop_by_twist_mm = twist_rad * L2 * std::abs(s) / kMm;
  effect->drop_by_bending_mm = of.gravity_m_s2 *
                               (elbow_kg + link2.mass_kg() + arm.payload_mass_kg) /
                               shaft.StiffnessAcross_n_per_m() / kMm;
  effect->twist_deg_per_m_s2 = arm.motor2_mass_kg * e / stiffness / kRadPerDeg;
}

void AddLink2(const ArmParameters& arm, const TwistingLink& shaft, TorsionEffect* effect) {
  const BeamTip payload{arm.payload_mass_kg, arm.payload_inertia_kgm2};
  const TwistTip beside{payload, effect->of.payload_offset_mm * kMm, 0.0};
  for (const BeamMode& mode : ClampedModes(arm.link[1].section, payload, kTorsionModes, "link 2")) {
    effect->bending_hz.push_back(mode.frequency_rad_s() / kTwoPi);
  }
  effect->coupled_hz = shaft.CoupledHz(beside, kTorsionModes);
  const double lowest = effect->coupled_hz.front();
  effect->first_shift_percent = 100.0 * (lowest / effect->bending_hz.front() - 1.0);
  effect->twist_deg_per_mm = kMm * shaft.TwistPerDeflection_rad_per_m(beside, lowest) / kRadPerDeg;
}

}  // namespace

std::string LacksRectangles(const ArmParameters& arm) {
  constexpr double kSame = 0.1;
  for (std::size_t i = 0; i < arm.link.size(); ++i) {
    const std::vector<BeamSection>& section = arm.link[i].section;
    for (std::size_t j = 0; j < section.size(); ++j) {
      const std::string name =
          "link" + std::to_string(i + 1) + ".section[" + std::to_string(j) + "]";
      if (!section[j].has_cross_section) {
        return name + " has no area_m2 and second_moment_m4, from which torsion follows";
      }
      const double thickness_m = RectangularSection(section[j]).thickness_m;
      if (std::abs(thickness_m / (2.0 * section[j].half_thickness_m) - 1.0) <= kSame) continue;
      return name + " is no solid rectangle, of which alone torsion is computed: area_m2 and " +
             "second_moment_m4 make it " + Figure(thickness_m / kMm) +
             " mm thick, half_thickness_m " + Figure(2.0 * section[j].half_thickness_m / kMm) +
             " mm";
    }
  }
  return "";
}

TorsionEffect TorsionOf(const ArmParameters& arm, const TorsionCase& of) {
  if (const std::string lacks = LacksRectangles(arm); !lacks.empty()) {
    throw std::invalid_argument(lacks);
  }
  TorsionEffect effect{};
  effect.of = of;
  const TwistingLink shaft1(arm.link[0].section, of.poisson);
  const TwistingLink shaft2(arm.link[1].section, of.poisson);
  effect.link = {AsShaft(arm.link[0], shaft1), AsShaft(arm.link[1], shaft2)};
  AddLink1(arm, shaft1, &effect);
  AddLink2(arm, shaft2, &effect);
  return effect;
}

nlohmann::ordered_json TorsionJson(const TorsionEffect& effect) {
  nlohmann::ordered_json json;
  json["assumed"] = {{"theta2_deg", effect.of.theta2_deg},
                     {"poisson", effect.of.poisson},
                     {"payload_offset_mm", effect.of.payload_offset_mm},
                     {"motor_offset_mm", effect.of.motor_offset_mm},
                     {"gravity_m_s2", effect.of.gravity_m_s2}};
  for (const LinkTorsion& link : effect.link) {
    json["links"].push_back({{"width_mm", link.width_mm},
                             {"thickness_mm", link.thickness_mm},
                             {"torsion_constant_m4", link.torsion_constant_m4},
                             {"stiffness_nm_per_rad", link.stiffness_nm_per_rad},
                             {"free_hz", link.free_hz}});
  }
  json["link1_carrying"] = {{"inertia_kgm2", effect.carried_inertia_kgm2},
                            {"frequency_hz", effect.carried_hz},
                            {"weight_nm", effect.weight_nm},
                            {"twist_deg", effect.twist_deg},
                            {"tip_drop_by_twist_mm", effect.drop_by_twist_mm},
                            {"elbow_drop_by_bending_mm", effect.drop_by_bending_mm},
                            {"twist_deg_per_m_s2", effect.twist_deg_per_m_s2}};
  json["link2_with_payload"] = {{"bending_hz", effect.bending_hz},
                                {"coupled_hz", effect.coupled_hz},
                                {"first_shift_percent", effect.first_shift_percent},
                                {"twist_deg_per_mm", effect.twist_deg_per_mm}};
  return json;
}

}  // namespace flexarm
