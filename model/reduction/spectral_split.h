#pragma once

#include <Eigen/Core>

namespace flexarm {

/// x' = A x + B u, y = C x.
struct StateSpace {
  Eigen::MatrixXd A, B, C;
};

/// A system taken apart: what dies away, and what stays, drifts or grows.
///
/// x = V_stable x_s + V_rest x_r; both parts run on their own and their outputs add up.
struct SplitSystem {
  StateSpace stable;  ///< all eigenvalues left of the line
  StateSpace rest;    ///< the others: rigid-body motions, unstable modes; may have no state
  Eigen::MatrixXd V_stable, V_rest;
};

/// Splits at the line Re = -margin, by an ordered complex Schur form and a Sylvester equation.
///
/// A Jordan block on the imaginary axis (a rigid body) goes to the rest whole: round-off spreads
/// its eigenvalues by about sqrt(1e-16 |A|), which the margin has to exceed.
/// @param margin_per_s  > 0, 1/s
/// @throws std::invalid_argument if sizes do not fit or an entry is not finite; std::domain_error
/// if an eigenvalue of one part is one of the other's as well.
SplitSystem SplitStable(const StateSpace& system, double margin_per_s);

/// F with F F' = P, A P + P A' + B B' = 0: a factor of the reachability Gramian, n x n.
///
/// Hammarling's method on the complex Schur form: the Gramian is never formed, so that small
/// Hankel singular values keep their digits. With (A', C') it is the observability Gramian's.
/// @throws std::invalid_argument if A has an eigenvalue with Re >= 0.
Eigen::MatrixXd GramianFactor(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace flexarm
