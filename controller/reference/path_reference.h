#pragma once

#include <array>
#include <span>
#include <vector>

#include "controller/reference/planned_move.h"
#include "controller/types/step_types.h"
#include "model/rigid_joint/quasi_static_map.h"
#include "model/rigid_joint/rigid_joint_arm.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// The way of planned moves, sample by sample.
class RigidPath {
 public:
  /// From the `first` of a move to that of the next, the path is that move's.
  /// @param moves      in order of time; what is before them rests at `start_rad`
  /// @param periods    of the experiment
  RigidPath(std::span<const PlannedMove> moves, const std::array<double, 2>& start_rad, int periods,
            double period_s);

  /// Y, k periods after the start; before it the rest at the start, after the end the rest there.
  /// Real-time: safe.
  const RigidPoint& At(int k) const noexcept;

  /// At k - 1, k and k + 1. Real-time: safe.
  std::array<RigidPoint, 3> Around(int k) const noexcept { return {At(k - 1), At(k), At(k + 1)}; }

  int periods() const noexcept { return static_cast<int>(point_.size()) - 1; }

 private:
  std::vector<RigidPoint> point_;
};

/// The reference of the laws that know the payload: an arm that is bent along the path without
/// vibrating, x_m and u_m by QuasiStaticOver, of the samples from `first` to `last`.
std::vector<ReferenceSample> QuasiStaticReference(const RigidPath& path, const RigidJointArm& arm,
                                                  double payload_kg, double period_s, int first,
                                                  int last);

}  // namespace flexarm
