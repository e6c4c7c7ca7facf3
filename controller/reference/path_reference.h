#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "controller/reference/planned_move.h"
#include "controller/types/step_types.h"
#include "model/rigid_joint/quasi_static_map.h"
#include "model/rigid_joint/rigid_joint_arm.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// Rigid-body path of planned moves, sample by sample.
class RigidPath {
 public:
  /// From its `first` sample until that of the next move the path is that of the move.
  /// @param moves      in order of time; before them the path rests at `start_rad`
  /// @param periods    of the experiment
  RigidPath(std::span<const PlannedMove> moves, const std::array<double, 2>& start_rad, int periods,
            double period_s);
  /// A path sample by sample; not empty.
  explicit RigidPath(std::vector<RigidPoint> point) : point_(std::move(point)) {}

  /// Y, k periods after the start; before the start and after the end the path is at rest.
  /// Real-time: safe.
  const RigidPoint& At(int k) const noexcept;

  /// At k - 1, k and k + 1. Real-time: safe.
  std::array<RigidPoint, 3> Around(int k) const noexcept { return {At(k - 1), At(k), At(k + 1)}; }

  int periods() const noexcept { return static_cast<int>(point_.size()) - 1; }

 private:
  std::vector<RigidPoint> point_;
};

/// Sample of the reference of the laws that use the estimated payload: x_m and u_m by
/// QuasiStaticOver. Real-time: safe.
/// @param path  at the sample before, at it, and after
ReferenceSample QuasiStaticSample(const RigidJointArm& arm, double payload_kg,
                                  const std::array<RigidPoint, 3>& path, double period_s) noexcept;

/// The reference of the laws that use the estimated payload: an arm bent quasi-statically along the
/// path, without vibration; x_m and u_m by QuasiStaticOver for the samples `first` to `last`.
std::vector<ReferenceSample> QuasiStaticReference(const RigidPath& path, const RigidJointArm& arm,
                                                  double payload_kg, double period_s, int first,
                                                  int last);

}  // namespace flexarm
