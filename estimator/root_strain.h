#pragma once

#include <array>

#include "model/beam/link_modes.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Surface strain per metre of each modal coordinate, (h/2) psi_j'', at the root of the section
/// where the first mode strains the surface most.
///
/// That is the root of the link, unless the link is stiffer there. Unit: 1/m. A link of one mode
/// has 0 for the second.
/// Source: thesis B.2. Real-time: start-up only.
std::array<double, 2> RootStrainShape(const LinkParameters& link, const LinkModes& modes);

/// RootStrainShape of both links, of the arm's first modes.
/// @param modes  a link, 1 or 2
std::array<std::array<double, 2>, 2> RootStrainShapes(const ArmParameters& arm, int modes);

/// Bending moment per unit of surface strain, EI / (h/2), of the weakest section, N m.
double MomentPerStrain_nm(const LinkParameters& link);

}  // namespace flexarm
