#include "config/thesis_arm.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "model/problem_list.h"

namespace flexarm {
namespace {

/// A link of Table 2.
struct ThesisLink {
  double length_m, area_m2, second_moment_m4;
};
constexpr std::array<ThesisLink, 2> kLinks = {
    {{.length_m = 0.8, .area_m2 = 1.575e-4, .second_moment_m4 = 2.657e-10},
     {.length_m = 0.9, .area_m2 = 9.525e-5, .second_moment_m4 = 8.001e-11}}};
constexpr double kElbow_kg = 0.24 + 3.03;  // M_h2 + M_r2

bool Differs(double value, double thesis) { return std::abs(value - thesis) > 1e-3 * thesis; }

}  // namespace

std::string DiffersFromThesisArm(const ArmParameters& arm) {
  for (std::size_t i = 0; i < kLinks.size(); ++i) {
    const std::string link = "its link " + std::to_string(i + 1);
    const LinkParameters& is = arm.link[i];
    if (Differs(is.length_m(), kLinks[i].length_m)) {
      return link + " is " + NumberText(is.length_m()) + " m long, the thesis's " +
             NumberText(kLinks[i].length_m) + " m";
    }
    for (const BeamSection& section : is.section) {
      if (section.has_cross_section && !Differs(section.area_m2, kLinks[i].area_m2) &&
          !Differs(section.second_moment_m4, kLinks[i].second_moment_m4)) {
        continue;
      }
      return link + " has another cross section than the thesis's";
    }
  }
  const double elbow_kg = arm.hub2_mass_kg + arm.motor2_mass_kg;
  if (!Differs(elbow_kg, kElbow_kg)) return "";
  return "its elbow has " + NumberText(elbow_kg) + " kg, the thesis's " + NumberText(kElbow_kg) +
         " kg";
}

}  // namespace flexarm
