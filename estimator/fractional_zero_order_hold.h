#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/piecewise_torque.h"
#include "model/math/discretize.h"

namespace flexarm {

/// Zero-order hold over any fraction of a period: x' = A x + B u under piecewise constant torque.
///
/// The zero-order holds of Ts, Ts/2 .. Ts/2^16 are computed off line. They are functions of one
/// matrix and commute, so applying those of the binary digits of a duration one after the other is
/// the exact hold of that duration. On line there are products and sums only, so a replay is exact
/// to the bit.
/// Real-time: Advance is safe; the constructor is not.
class FractionalZeroOrderHold {
 public:
  /// @param whole_period  the hold of one period, from the design
  /// @param A, B  the same system, continuous, n x n and n x 2; 1/s
  FractionalZeroOrderHold(const DiscreteModel& whole_period, const Eigen::MatrixXd& A,
                          const Eigen::MatrixXd& B, double period_s);

  /// Advances `x` over all pieces.
  template <typename Vector>
  void Advance(const PiecewiseTorque& torque, Vector* x) const noexcept {
    for (const TorquePiece& piece : torque.all()) {
      for (std::int64_t period = 0; period < piece.ticks / kPeriodTicks; ++period) {
        Hold(hold_[0], piece, x);
      }
      for (int digit = 1; digit <= kPeriodDigits; ++digit) {
        if ((piece.ticks >> (kPeriodDigits - digit) & 1) != 0) {
          Hold(hold_[static_cast<std::size_t>(digit)], piece, x);
        }
      }
    }
  }

 private:
  template <typename Vector>
  static void Hold(const DiscreteModel& hold, const TorquePiece& piece, Vector* x) noexcept {
    Vector next = hold.A.lazyProduct(*x);
    next += hold.B.col(0) * piece.torque_nm[0];
    next += hold.B.col(1) * piece.torque_nm[1];
    *x = next;
  }

  std::vector<DiscreteModel> hold_;  // of Ts / 2^j
};

}  // namespace flexarm
