#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "config/plausibility/plausibility_rules.h"
#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"
#include "model/problem_list.h"
#include "model/units.h"

namespace flexarm {
namespace {

/// A range in which a quantity of real arms lies, and the factor by which a wrong unit misses it.
struct UsualRange {
  double low, high;
  double unit_factor;      ///< SI units in one of `other_unit`
  const char* other_unit;  ///< in which the number would be usual
  const char* examples;
};

constexpr UsualRange kModulus = {1e9, 5e11, 1e9, "GPa",
                                 "polymers from 1e9, aluminium 7e10, steel 2.07e11, tungsten 4e11"};
constexpr UsualRange kDensity = {500.0, 25000.0, 1000.0, "g/cm^3",
                                 "polymers from 900, aluminium 2700, steel 7850, tungsten 19300"};
constexpr UsualRange kLength = {0.03, 30.0, 1e-3, "mm", "m, root to tip"};

std::string SectionKey(std::size_t link, std::size_t section) {
  return "link" + NumberText(link + 1) + "." + ProblemList::Element("section", section) + ".";
}

void JudgeRange(const UsualRange& range, const std::string& key, double value,
                ImplausibleValueList* found) {
  if (value >= range.low && value <= range.high) return;
  const double in_other_unit = value * range.unit_factor;
  const bool slipped = in_other_unit >= range.low && in_other_unit <= range.high;
  found->push_back(
      {key, NumberText(value),
       std::string(value < range.low ? "unusually small" : "unusually large") +
           (slipped ? std::string(", perhaps meant in ") + range.other_unit : std::string()),
       NumberText(range.low) + " to " + NumberText(range.high) + " (" + range.examples + ")"});
}

double SoftestSection_nm2(const LinkParameters& link) {
  double softest = link.section.front().bending_stiffness_nm2();
  for (const BeamSection& section : link.section) {
    softest = std::min(softest, section.bending_stiffness_nm2());
  }
  return softest;
}

bool HasGauge(const SensorConfig& sensors, int link, double start_m, double end_m) {
  return std::any_of(sensors.strain.begin(), sensors.strain.end(), [=](const auto& gauge) {
    return gauge.link == link && gauge.position_m >= start_m && gauge.position_m <= end_m;
  });
}

void JudgeThicknessOf(const BeamSection& section, const std::string& path,
                      ImplausibleValueList* found) {
  constexpr double kFactor = 2.0;  // of I: a rod has 3/4 of a rectangle's, a thin tube 3/2
  const double c = section.half_thickness_m;
  const double rectangle_m4 = section.area_m2 * c * c / 3.0;
  const double ratio = section.second_moment_m4 / rectangle_m4;
  if (ratio >= 1.0 / kFactor && ratio <= kFactor) return;
  found->push_back({path + "half_thickness_m", NumberText(c),
                    "second_moment_m4 = " + NumberText(section.second_moment_m4) + " is " +
                        ShortNumber(ratio) +
                        " times that of a rectangle with this area and thickness",
                    "half_thickness_m " +
                        ShortNumber(std::sqrt(3.0 * section.second_moment_m4 / section.area_m2)) +
                        ", or second_moment_m4 " + ShortNumber(rectangle_m4) +
                        ": I = A (2c)^2 / 12, within a factor of 2 for other shapes"});
}

}  // namespace

std::string ShortNumber(double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  return text.str();
}

// The sum: a section of a link may be short.
ImplausibleValueList JudgeLinkLengths(const ControlConfig& config) {
  ImplausibleValueList found;
  for (std::size_t i = 0; i < 2; ++i) {
    const LinkParameters& link = config.arm.link[i];
    const bool uniform = link.section.size() == 1;
    JudgeRange(kLength,
               uniform ? SectionKey(i, 0) + "length_m" : "link" + NumberText(i + 1) + ".section",
               link.length_m(), &found);
  }
  return found;
}

ImplausibleValueList JudgeMaterials(const ControlConfig& config) {
  ImplausibleValueList found;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < config.arm.link[i].section.size(); ++j) {
      const BeamSection& section = config.arm.link[i].section[j];
      if (!section.has_cross_section) continue;
      JudgeRange(kModulus, SectionKey(i, j) + "youngs_modulus_pa", section.youngs_modulus_pa,
                 &found);
      JudgeRange(kDensity, SectionKey(i, j) + "density_kg_m3", section.density_kg_m3, &found);
    }
  }
  return found;
}

// A clamp or a hub is often described as a short section of any area that does not bend. Its
// thickness is used nowhere if no gauge is on it.
ImplausibleValueList JudgeThickness(const ControlConfig& config) {
  constexpr double kRigid = 100.0;
  ImplausibleValueList found;
  for (std::size_t i = 0; i < 2; ++i) {
    const LinkParameters& link = config.arm.link[i];
    const double rigid_nm2 = kRigid * SoftestSection_nm2(link);
    double start_m = 0.0;
    for (std::size_t j = 0; j < link.section.size(); ++j) {
      const BeamSection& section = link.section[j];
      const double end_m = start_m + section.length_m;
      const bool bends = section.bending_stiffness_nm2() < rigid_nm2;
      const int number = static_cast<int>(i) + 1;
      if (section.has_cross_section &&
          (bends || HasGauge(config.sensors, number, start_m, end_m))) {
        JudgeThicknessOf(section, SectionKey(i, j), &found);
      }
      start_m = end_m;
    }
  }
  return found;
}

ImplausibleValueList JudgeDamping(const ControlConfig& config) {
  constexpr double kHigh = 0.2;
  ImplausibleValueList found;
  if (config.arm.damping == DampingReading::kNone) return found;
  for (std::size_t i = 0; i < 2; ++i) {
    const double ratio = config.arm.link[i].damping_ratio;
    if (ratio <= kHigh) continue;
    found.push_back({"link" + NumberText(i + 1) + ".damping_ratio", NumberText(ratio),
                     "the link hardly vibrates; in per cent the number would be usual",
                     "0.001 to 0.1: bare metal 0.005, with cables and glued gauges up to 0.1"});
  }
  return found;
}

ImplausibleValueList JudgeJointTwist(const ControlConfig& config) {
  constexpr double kMost_rad = 0.2;
  ImplausibleValueList found;
  for (std::size_t i = 0; i < 2; ++i) {
    const double stiffness = config.arm.joint[i].stiffness_nm_per_rad;
    const double twist_rad = config.safety.torque_limit_nm[i] / stiffness;
    if (twist_rad <= kMost_rad) continue;
    found.push_back({"joint" + NumberText(i + 1) + ".stiffness_nm_per_rad", NumberText(stiffness),
                     "the torque limit of " + NumberText(config.safety.torque_limit_nm[i]) +
                         " N m twists the joint by " + ShortNumber(twist_rad / kRadPerDeg) + " deg",
                     "above " + ShortNumber(config.safety.torque_limit_nm[i] / kMost_rad) +
                         "; a stiffness in N m per degree is 57.3 times this in N m per rad"});
  }
  return found;
}

}  // namespace flexarm
