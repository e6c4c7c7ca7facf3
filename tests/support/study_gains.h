#pragma once

#include <numbers>

#include "controller/design/gain_table_design.h"

namespace flexarm {

/// Weights of docs/theory/payload.md 4.2 and docs/theory/control-law.md 3.1.
inline GainWeights StudyWeights(double alpha_per_s) {
  return {
      .state = {100, 20, 0, 0, 0, 0, 5, 1, 0, 0, 0, 0}, .torque = 2.0, .alpha_per_s = alpha_per_s};
}

/// Knots of docs/theory/payload.md 4.2.
inline GainGrid StudyGrid() {
  GainGrid grid{.payload_kg = {0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0}, .theta2_rad = {}};
  for (const double theta2_deg : {0, 20, 40, 60, 80, 100, 120, 150}) {
    grid.theta2_rad.push_back(theta2_deg * std::numbers::pi / 180.0);
  }
  return grid;
}

}  // namespace flexarm
