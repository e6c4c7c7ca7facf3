#pragma once

#include <optional>

#include "controller/law/design.h"
#include "controller/reference/motion_check.h"
#include "controller/reference/motion_limits.h"
#include "controller/reference/path_reference.h"

namespace flexarm {

/// Checks a path against the limits for every payload up to the largest.
///
/// Applies FirstBrokenLimit to two arms: one bent by the largest payload that moves are planned
/// for, and a rigid one, whose hubs are at Y. The hubs lead the tip, by more for a heavier payload:
/// where a move accelerates, the hubs of the heavy arm go beyond Y, where it turns round they stay
/// behind, and those of a light arm are between. Torque and strain are those of the heavy arm.
class PathCheck {
 public:
  /// @param design  for a law that follows a path
  /// @param share   of the limits, 0 .. 1
  PathCheck(const Design& design, const MotionLimits& limits, double share, double period_s);

  /// The first violation of a limit in the samples `first` to `last`.
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
