#pragma once

#include <Eigen/Core>

namespace flexarm {

/// Number of singular values above `tolerance` times the largest.
int NumericalRank(const Eigen::MatrixXd& A, double tolerance = 1e-9);

/// Invariant zeros of the square system x' = A x + B u, y = C x (or x(k+1) = ..): the numbers s for
/// which [A - s I, B; C, 0] loses rank. Those at infinity are left out.
///
/// They are the eigenvalues of A on V*, the largest subspace of states that an input can hold while
/// y stays zero: V_0 = null C, V_k+1 = those x of V_k with A x in V_k + im B. In balanced
/// coordinates; dimensions by singular values above 1e-9 of the largest.
/// Source: Wonham, Linear Multivariable Control, 1979, 4.3 and 5.5.
/// Real-time: start-up only (allocates).
/// @throws std::invalid_argument if the sizes do not fit or the system is not invertible: then
/// every s is a zero
Eigen::VectorXcd InvariantZeros(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                const Eigen::MatrixXd& C);

/// The poles of a system that integrate: its eigenvalues at 0, or at 1 if it is discrete.
struct Integrators {
  int poles;   ///< algebraic multiplicity of that eigenvalue: the dimension of null A^n
  int chains;  ///< geometric: of null A. With fewer chains than poles some integrate in series
};

/// @param at  0 for x' = A x, 1 for x(k+1) = A x(k)
Integrators CountIntegrators(const Eigen::MatrixXd& A, double at = 0.0);

}  // namespace flexarm
