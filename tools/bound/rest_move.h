#pragma once

#include <Eigen/Core>

namespace flexarm {

/// A move from rest to rest.
struct RestMove {
  Eigen::Vector2d from_rad;  ///< th1, th2 of the unbent arm
  Eigen::Vector2d to_rad;
  double payload_kg;  ///< >= 0
};

}  // namespace flexarm
