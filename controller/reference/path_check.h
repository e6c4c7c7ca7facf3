#pragma once

#include <optional>

#include "controller/law/design.h"
#include "controller/reference/motion_check.h"
#include "controller/reference/motion_limits.h"
#include "controller/reference/path_reference.h"

namespace flexarm {

/// Compares a path with the limits, whatever the payload that follows it.
///
/// FirstBrokenLimit of two arms: bent by the heaviest payload that moves are planned for, and
/// rigid, whose hubs are at Y. The hubs lead the tip, the more the heavier it is: where a move
/// speeds up the heavy arm's go farther than Y, where it turns round they stay behind, and a
/// light arm's are between. Torque and strain are those of the heavy one.
class PathCheck {
 public:
  /// @param design  for a law that follows a path
  /// @param share   of the limits, 0 .. 1
  PathCheck(const Design& design, const MotionLimits& limits, double share, double period_s);

  /// The first of the samples `first` to `last` that breaks a limit.
  std::optional<BrokenLimit> First(const RigidPath& path, int first, int last) const;

 private:
  RigidJointArm arm_;
  double max_kg_;
  int states_;
  const MotionLimits& limits_;
  double share_;
  double period_s_;
};

}  // namespace flexarm
