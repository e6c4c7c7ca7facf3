#pragma once

#include <optional>

#include "controller/law/design.h"
#include "controller/reference/motion_check.h"
#include "controller/reference/motion_limits.h"
#include "controller/reference/path_reference.h"

namespace flexarm {

/// Checks a path against the limits for every payload up to the largest.
///
/// Applies FirstBrokenLimit to three arms: bent by the largest payload that moves are planned for,
/// bent without payload, and a rigid one, whose hubs are at Y. The hubs lead the tip, by more for a
/// heavier payload: where a move accelerates, the hubs of the heavy arm go beyond Y, where it turns
/// round they stay behind, and those of a light arm are between. Torque and strain are mostly those
/// of the heavy arm, but where the inertial forces of the payload act against those of the elbow,
/// in 4 % of random moves, the empty arm's are larger; no payload between needs more than both.
class PathCheck {
 public:
  /// @param design  for a law that follows a path
  PathCheck(const Design& design, const MotionLimits& limits, const LimitShares& shares,
            double period_s);

  /// The first violation of a limit in the samples `first` to `last`.
  std::optional<BrokenLimit> First(const RigidPath& path, int first, int last) const;

  /// The same of the arm bent by this payload alone.
  std::optional<BrokenLimit> FirstWith(double payload_kg, const RigidPath& path, int first,
                                       int last) const;

 private:
  RigidJointArm arm_;
  double max_kg_;
  int states_;
  const MotionLimits& limits_;
  LimitShares shares_;
  double period_s_;
};

}  // namespace flexarm
