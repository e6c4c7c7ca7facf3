#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/piecewise_torque.h"
#include "model/math/discretize.h"

namespace flexarm {

/// x' = A x + B u over any fraction of a period, under torques that are constant in pieces.
///
/// The zero-order holds of Ts, Ts/2 .. Ts/2^16 are made off line. They commute, being functions of
/// one matrix, so those that are set in the binary digits of a duration, one after the other, are
/// the exact hold of that duration. On line there are products and sums only: replay is to the bit.
/// Real-time: Advance is safe; the constructor is not.
class FractionalZeroOrderHold {
 public:
  /// @param whole_period  the hold of one period, as the design has it
  /// @param A, B  the same system, continuous, n x n and n x 2; 1/s
  FractionalZeroOrderHold(const DiscreteModel& whole_period, const Eigen::MatrixXd& A,
                          const Eigen::MatrixXd& B, double period_s);

  /// Moves `x` along all pieces.
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
