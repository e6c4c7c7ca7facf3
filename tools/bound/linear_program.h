#pragma once

#include <Eigen/Core>
#include <optional>

namespace flexarm {

/// Linear program: the least cost'x with rows x <= limit and low <= x <= high.
struct LinearProgram {
  Eigen::VectorXd cost;
  Eigen::MatrixXd rows;
  Eigen::VectorXd limit;
  Eigen::VectorXd low, high;  ///< of every variable, low <= high
};

/// Primal-dual interior-point method with Mehrotra's predictor and corrector, for some hundred
/// variables and dense rows.
///
/// The normal equations have the size of x: the bounds add to their diagonal only. Ends when the
/// mean product of slack and multiplier is below 1e-9 of the cost's scale.
/// Source: Nocedal and Wright, Numerical Optimization, chapter 14.
/// @returns  nothing if it does not converge, as when no x keeps all rows
std::optional<Eigen::VectorXd> SolveLinearProgram(const LinearProgram& program);

}  // namespace flexarm
