#include "estimator/root_strain.h"

#include <cmath>
#include <cstddef>

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

}  // namespace flexarm
