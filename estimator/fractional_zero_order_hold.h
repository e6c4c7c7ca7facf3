#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "estimator/piecewise_torque.h"
#include "model/math/discretize.h"

namespace flexarm {

/// Zero-order hold over any fraction of a period: x' = A x + B u under piecewise constant torque.
///
/// The zero-order holds of Ts and of 1 .. 15 times Ts/16, Ts/16^2 .. Ts/16^4 are computed off line.
/// They are functions of one matrix and commute, so applying those of the digits of a duration to
/// base 16, one after the other, is the exact hold of that duration. On line there are products and
/// sums only, so a replay is exact to the bit.
/// Real-time: Advance is safe; the constructor is not.
class FractionalZeroOrderHold {
 public:
  static constexpr int kMostStates = 24;

  /// @param whole_period  the hold of one period, from the design; at most kMostStates
  /// @param A, B  the same system, continuous, n x n and n x 2; 1/s
  FractionalZeroOrderHold(const DiscreteModel& whole_period, const Eigen::MatrixXd& A,
                          const Eigen::MatrixXd& B, double period_s);

  /// Advances `x` over all pieces.
  template <typename Vector>
  void Advance(const PiecewiseTorque& torque, Vector* x) const noexcept {
    Padded padded{};
    Eigen::Map<Eigen::VectorXd> states(padded.data(), x->size());
    states = *x;
    AdvancePadded(torque, &padded);
    *x = states;
  }

 private:
  struct alignas(16) Padded : std::array<double, kMostStates> {};  // as ColumnSum needs it

  void AdvancePadded(const PiecewiseTorque& torque, Padded* x) const noexcept;

  // [A B] of Ts, then of Ts/16, 2 Ts/16 .. 15 Ts/16, Ts/256 .., with rows of zeros up to a multiple
  // of four, so that loops take four at a time.
  std::vector<Eigen::MatrixXd> hold_;
};

}  // namespace flexarm
