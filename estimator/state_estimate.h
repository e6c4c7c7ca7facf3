#pragma once

#include <Eigen/Core>
#include <array>

namespace flexarm {

/// State of the nominal model, up to 16 states, in the order of its StateLayout, SI; no heap.
using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 16, 1>;

/// Result of an observer for one sample.
struct StateEstimate {
  StateVector x;
  std::array<double, 8> innovation;  ///< measured minus predicted outputs; 0 where not used
};

}  // namespace flexarm
