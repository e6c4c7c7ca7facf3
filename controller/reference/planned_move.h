#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "controller/law/design.h"
#include "controller/reference/duration_table.h"
#include "controller/types/motion_profile.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// A planned move: on the grid, between joint angles.
///
/// A move that retargets begins while the move before it lasts; from its `first` sample on the path
/// is its own, and the rest of the move before it is dropped.
struct PlannedMove {
  std::size_t row;               ///< of [[move]]
  int first;                     ///< sample at which it begins
  int periods;                   ///< n: the path is at rest from sample first + n on
  bool retargets;                ///< the move retargets: the arm moves when it begins
  RigidPoint from;               ///< Y at sample `first`: at rest, or of the move that it replaces
  std::array<double, 2> to_rad;  ///< th1, th2
  MoveProfile profile;           ///< from rest; a move that retargets is SepticToRest
  bool same_load = false;        ///< the payload is that of the move before
  bool is_shortest = false;      ///< takes all its periods: At
  /// The durations from which the run chooses when the move begins; `periods` is the longest.
  std::optional<DurationTable> choice{};

  /// Y and its derivatives of this move, `sample` periods after the experiment's start; analytic.
  ///
  /// A move from rest takes n - 1 periods, half a period after `first`, as the reference model's
  /// rigid angles do (ProfileAccelerations); a shortest one takes all n, from `first` on, as only
  /// laws that follow the path use it. A move that retargets begins at sample `first` itself,
  /// where it matches the path before it, and takes all n. Before `first` Y is `from`.
  /// Real-time: safe.
  RigidPoint At(double sample, double period_s) const noexcept;
};

/// u_m of a move from rest per unit of ProfileAccelerations: M_r (to - from), N m s^2.
Eigen::Vector2d TorqueOf(const PlannedMove& move, const Design& design);

}  // namespace flexarm
