#pragma once

#include <array>

#include "tools/status/styled_row.h"

namespace flexarm {

/// What the arm looks like. Angles, deflections: counter-clockwise positive.
struct ArmPose {
  std::array<double, 2> length_m;
  std::array<double, 2> angle_rad;  ///< of the hubs; the second from the end of link 1
  std::array<double, 2> bending_m;  ///< deflection of the end of each link
};

/// How much larger than it is the bending is drawn: a centimetre would be less than a dot.
inline constexpr double kBendingScale = 5.0;

/// The arm from above, the direction of zero upwards: base 'O', elbow 'o', tip 'x'. A bent link has
/// the shape of a cantilever with a force at its end. In UTF-8 a cell has 2 by 4 dots. Pure
/// function.
/// @returns `rows` rows of `columns` columns; of an arm without lengths, blank ones
Rows ArmDrawing(const ArmPose& pose, int columns, int rows, bool utf8);

}  // namespace flexarm
