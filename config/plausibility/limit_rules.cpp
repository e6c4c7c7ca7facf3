#include <algorithm>
#include <limits>
#include <string>

#include "config/plausibility/plausibility_rules.h"
#include "model/parameters/arm_parameters.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

// Moment that strains the surface of the link's weakest section to the limit, EI strain / c.
double MomentAt_nm(const LinkParameters& link, double strain) {
  double least = std::numeric_limits<double>::infinity();
  for (const BeamSection& section : link.section) {
    least = std::min(least, section.bending_stiffness_nm2() * strain / section.half_thickness_m);
  }
  return least;
}

}  // namespace

ImplausibleValueList JudgeFrictionTorques(const ControlConfig& config) {
  constexpr double kLeast = 2.0;  // times friction: half of the torque is left to move the arm
  ImplausibleValueList found;
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit_nm = config.safety.torque_limit_nm[i];
    const double friction_nm = config.arm.joint[i].coulomb_friction_nm;
    if (limit_nm >= kLeast * friction_nm) continue;
    const std::string key = "joint" + NumberText(i + 1) + ".coulomb_friction_nm";
    found.push_back({ProblemList::Element("limits.torque_limit_nm", i), NumberText(limit_nm),
                     key + " = " + NumberText(friction_nm) + " takes most of it",
                     "at least " + ShortNumber(kLeast * friction_nm) +
                         ", twice the friction; a motor's torque times its gear"});
  }
  return found;
}

ImplausibleValueList JudgeBendingTorques(const ControlConfig& config) {
  constexpr double kMost = 10.0;  // the hub's inertia takes a part of a motor's torque
  ImplausibleValueList found;
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit_nm = config.safety.torque_limit_nm[i];
    const double strain = config.safety.strain_limit[i];
    const double moment_nm = MomentAt_nm(config.arm.link[i], strain);
    if (limit_nm <= kMost * moment_nm) continue;
    found.push_back({ProblemList::Element("limits.torque_limit_nm", i), NumberText(limit_nm),
                     ShortNumber(moment_nm) + " N m bend link " + NumberText(i + 1) +
                         " to its strain limit of " + NumberText(strain) + "; this is " +
                         ShortNumber(limit_nm / moment_nm) + " times as much",
                     "below " + ShortNumber(kMost * moment_nm) +
                         ": the first strong command trips, or the link is described too soft"});
  }
  return found;
}

ImplausibleValueList JudgeStrainLimits(const ControlConfig& config) {
  constexpr double kLowest = 5e-5, kHighest = 5e-3;
  ImplausibleValueList found;
  for (std::size_t i = 0; i < 2; ++i) {
    const double strain = config.safety.strain_limit[i];
    if (strain >= kLowest && strain <= kHighest) continue;
    found.push_back({ProblemList::Element("limits.strain_limit", i), NumberText(strain),
                     strain > kHighest ? "most metals have yielded before"
                                       : "the least motion of a flexible link exceeds it",
                     "0.0005 to 0.003, as a share of the length: aluminium yields at 0.002 to "
                     "0.007, spring steel at 0.005"});
  }
  return found;
}

}  // namespace flexarm
