#include "estimator/root_strain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace flexarm {

std::array<double, 2> RootStrainShape(const LinkParameters& link, const LinkModes& modes) {
  std::array<double, 2> most{};
  double start = 0.0;
  for (const BeamSection& section : link.section) {
    std::array<double, 2> here{};
    for (std::size_t j = 0; j < modes.mode.size(); ++j) {
      here[j] = section.half_thickness_m * modes.mode[j].Curvature(start);
    }
    if (std::fabs(here[0]) > std::fabs(most[0])) most = here;
    start += section.length_m;
  }
  return most;
}

std::array<std::array<double, 2>, 2> RootStrainShapes(const ArmParameters& arm, int modes) {
  return {RootStrainShape(arm.link[0], Link1Modes(arm, modes)),
          RootStrainShape(arm.link[1], Link2Modes(arm, modes))};
}

double MomentPerStrain_nm(const LinkParameters& link) {
  double least = std::numeric_limits<double>::infinity();
  for (const BeamSection& section : link.section) {
    least = std::min(least, section.bending_stiffness_nm2() / section.half_thickness_m);
  }
  return least;
}

}  // namespace flexarm
