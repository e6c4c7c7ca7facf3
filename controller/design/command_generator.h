#pragma once

#include <Eigen/Core>

namespace flexarm {

/// Tracking problem: the discrete plant shall follow the reference model's output, C_p x = C_m x_m.
struct TrackingProblem {
  Eigen::MatrixXd A, B, Cp;    ///< plant
  Eigen::MatrixXd Am, Bm, Cm;  ///< reference model
  Eigen::VectorXd scale;       ///< x = scale .* z: solved in z, for its condition number
};

/// Command generator tracker (CGT): the plant trajectory whose output is that of the model.
///   x* = S11 x_m + S12 u_m,  u* = S21 x_m + S22 u_m
/// Source: thesis 7.3 and docs/theory/control-law.md 4.
struct CommandGenerator {
  Eigen::MatrixXd S11, S12, S21, S22;
  double condition;  ///< of the matrix [A - I, B; C_p, 0], scaled
};

/// @throws std::runtime_error if the plant has an invariant zero at 1, or one on a pole of A_m
CommandGenerator SolveCommandGenerator(const TrackingProblem& problem);

/// Condition number of the equation for S11 written as one linear system of n^2 unknowns, in the
/// coordinates of `scale`: bounds the ratio of the solution's error to round-off. Infinity when the
/// system is numerically singular.
///   (I - (A_m - I)' (x) Omega_11) vec S11 = vec(Omega_12 C_m)
double SteinCondition(const TrackingProblem& problem);

/// Largest violation of A S11 + B S21 = S11 Am, A S12 + B S22 = S11 Bm + S12, Cp S11 = Cm and
/// Cp S12 = 0 in scaled coordinates.
double TrackingResidual(const TrackingProblem& problem, const CommandGenerator& generator);

}  // namespace flexarm
