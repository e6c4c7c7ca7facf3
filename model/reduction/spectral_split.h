#pragma once

#include <Eigen/Core>

namespace flexarm {

/// x' = A x + B u, y = C x.
struct StateSpace {
  Eigen::MatrixXd A, B, C;
};

/// A system divided into its stable part and the rest, which persists, drifts or grows.
///
/// x = V_stable x_s + V_rest x_r; the parts are decoupled and their outputs add up.
struct SplitSystem {
  StateSpace stable;  ///< all eigenvalues left of the line
  StateSpace rest;    ///< the others: rigid-body motions, unstable modes; may have no state
  Eigen::MatrixXd V_stable, V_rest;
};

/// Splits at the line Re = -margin, by an ordered complex Schur form and a Sylvester equation.
///
/// A Jordan block on the imaginary axis (a rigid body) belongs to the rest as a whole: round-off
/// spreads its eigenvalues by about sqrt(1e-16 |A|), which the margin has to exceed.
/// @param margin_per_s  > 0, 1/s
/// @throws std::invalid_argument if sizes do not fit or an entry is not finite; std::domain_error
/// if both parts have a common eigenvalue.
SplitSystem SplitStable(const StateSpace& system, double margin_per_s);

/// F with F F' = P, A P + P A' + B B' = 0: a factor of the reachability Gramian, n x n.
///
/// Hammarling's method on the complex Schur form: the Gramian is never formed, so that small
/// Hankel singular values lose no digits. With (A', C') it is the observability Gramian's factor.
/// @throws std::invalid_argument if A has an eigenvalue with Re >= 0.
Eigen::MatrixXd GramianFactor(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace flexarm
