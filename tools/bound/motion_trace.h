#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/bound/bound_limits.h"

namespace flexarm {

/// One instant of a motion. Index 0 is joint or link 1.
struct TracePoint {
  double time_s;
  Eigen::Vector2d angle_rad;   ///< hubs
  Eigen::Vector2d rate_rad_s;  ///< hubs
  Eigen::Vector2d torque_nm;   ///< hubs
  Eigen::Vector2d strain;      ///< at the roots; of a rigid arm: RigidStrain
};

using MotionTrace = std::vector<TracePoint>;

/// Strain at the roots of links that do not bend: the hubs' torques over the root moments.
Eigen::Vector2d RigidStrain(const Eigen::Vector2d& torque_nm, const BoundLimits& limits);

/// A limit that a motion reaches.
struct BindingLimit {
  std::string key;    ///< in the config, as "limits.strain_limit"
  int index;          ///< joint or link, 1 or 2
  double largest;     ///< largest share of the limit
  double time_share;  ///< share of the time at kBindingShare of the limit or more
};

inline constexpr double kBindingShare = 0.98;  ///< of a limit: the motion is held up by it

/// The limits that the motion reaches, that of the longest time first.
std::vector<BindingLimit> BindingLimits(const MotionTrace& trace, const BoundLimits& limits);

}  // namespace flexarm
