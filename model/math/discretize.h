#pragma once

#include <Eigen/Core>

namespace flexarm {

/// x(k+1) = A x(k) + B u(k).
struct DiscreteModel {
  Eigen::MatrixXd A;
  Eigen::MatrixXd B;
};

/// Zero-order hold of x' = A x + B u over one period, by the exponential of [[A, B], [0, 0]] Ts.
///
/// Scaling and squaring with a Pade approximant of degree up to 13 (Higham 2005), on a matrix
/// balanced by powers of two, so that mixed units (rad, m, N/m) lose no digits.
/// @param period_s  Ts > 0, s
/// @throws std::invalid_argument if the sizes do not fit or the period is not positive.
DiscreteModel ZeroOrderHold(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double period_s);

/// exp(A), square A.
Eigen::MatrixXd MatrixExponential(const Eigen::MatrixXd& A);

}  // namespace flexarm
