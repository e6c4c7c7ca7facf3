#pragma once

#include <array>

namespace flexarm {

/// What the simulated arm really did at a sampling instant. A rig does not know it.
struct PlantTruth {
  std::array<double, 2> hub_angle_rad;     ///< th1, th2
  std::array<double, 2> tip_m;             ///< x, y in the base frame
  std::array<double, 2> tip_deflection_m;  ///< w1(L1), w2(L2)
  bool known;
};

}  // namespace flexarm
