#pragma once

#include <limits>

#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// Whether the path moves, and for how long it has been at rest. Real-time: safe.
class MotionState {
 public:
  void Reset() noexcept { *this = MotionState(); }

  /// Takes the point of each sample, in order.
  /// @returns true when a move begins
  bool Take(const RigidPoint& point, double period_s) noexcept {
    const bool moved = moving_;
    moving_ = Moves(point);
    rested_s_ = moving_ ? 0.0 : rested_s_ + period_s;
    return moving_ && !moved;
  }

  bool moving() const noexcept { return moving_; }
  double rested_s() const noexcept { return rested_s_; }  ///< infinite before the first move

 private:
  static bool Moves(const RigidPoint& point) noexcept {
    return point.rate_rad_s[0] != 0.0 || point.rate_rad_s[1] != 0.0;
  }

  bool moving_ = false;
  double rested_s_ = std::numeric_limits<double>::infinity();
};

}  // namespace flexarm
