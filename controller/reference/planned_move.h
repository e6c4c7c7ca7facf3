#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "controller/law/design.h"
#include "controller/types/motion_profile.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// A move with everything decided: on the grid, between joint angles.
///
/// One that takes over begins while the move before it lasts; from its `first` on the path is its
/// own, whatever the move before it still had to do.
struct PlannedMove {
  std::size_t row;               ///< of [[move]]
  int first;                     ///< sample at which it begins
  int periods;                   ///< n: it rests at its end from sample first + n on
  bool takes_over;               ///< the arm moves when it begins
  RigidPoint from;               ///< Y at sample `first`: at rest, or of the move taken over
  std::array<double, 2> to_rad;  ///< th1, th2
  MoveProfile profile;           ///< from rest; what takes over is SepticToRest

  /// Y and its derivatives, `sample` periods after the experiment's start, of this move; analytic.
  ///
  /// From rest it takes n - 1 periods, half a period behind `first`, as the reference model's rigid
  /// angles do (ProfileAccelerations). What takes over begins at sample `first` itself, where the
  /// path of the move before it is matched, and takes all n. Before `first` it is `from`.
  /// Real-time: safe.
  RigidPoint At(double sample, double period_s) const noexcept;
};

/// u_m of a move from rest per unit of ProfileAccelerations: M_r (to - from), N m s^2.
Eigen::Vector2d TorqueOf(const PlannedMove& move, const Design& design);

}  // namespace flexarm
