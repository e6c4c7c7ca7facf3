#pragma once

#include <Eigen/Core>

namespace flexarm {

/// Stabilising solution P of the discrete algebraic Riccati equation
///   P = A'PA - A'PB (R + B'PB)^-1 B'PA + Q.
///
/// Structure-preserving doubling (Chu, Fan, Lin, Wang 2004): quadratic convergence, symmetric at
/// every step. Then Newton corrections, a Stein equation each, until the residual stops falling.
/// @param Q, R  symmetric; Q >= 0, R > 0
/// @throws std::invalid_argument if sizes do not fit or R is not positive definite;
/// std::runtime_error if the doubling does not converge (a mode on or outside the unit circle that
/// B does not reach, or on it and not weighted by Q).
Eigen::MatrixXd SolveDare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                          const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R);

/// Largest entry of the right side minus the left, over the largest entry of P.
double DareResidual(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
                    const Eigen::MatrixXd& R, const Eigen::MatrixXd& P);

/// K = (R + B'PB)^-1 B'PA, so that u = -K x.
Eigen::MatrixXd DareGain(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                         const Eigen::MatrixXd& R, const Eigen::MatrixXd& P);

/// Solution X (n x m) of the Stein equation X - A X B = C.
///
/// Complex Schur forms of A (n x n) and B (m x m), column by column, with two rounds of iterative
/// refinement. Eigenvalues may lie anywhere, on the unit circle too; only products of one of A with
/// one of B must stay away from 1. The caller scales badly scaled coordinates.
/// @throws std::invalid_argument if sizes do not fit; std::runtime_error if such a product is
/// within 1e-13 of 1: then there is no solution, or no unique one.
Eigen::MatrixXd SolveStein(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                           const Eigen::MatrixXd& C);

}  // namespace flexarm
