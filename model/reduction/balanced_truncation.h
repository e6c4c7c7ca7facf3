#pragma once

#include <Eigen/Core>

#include "model/reduction/spectral_split.h"

namespace flexarm {

/// A linear system with its stable part in balanced coordinates: both Gramians diag(hankel).
///
/// For comparison with power balancing: includes the damping and has an error bound.
/// Source: Moore 1981; square-root form of Tombs and Postlethwaite 1987.
struct BalancedSystem {
  Eigen::VectorXd hankel;  ///< Hankel singular values of the stable part, descending
  StateSpace stable;       ///< balanced, as many states as there are Hankel values above round-off
  StateSpace rest;         ///< not left of the line: no truncation reduces it
  Eigen::MatrixXd L;       ///< x = L x_balanced + ..: columns as states of `stable`

  int rest_states() const { return static_cast<int>(rest.A.rows()); }
};

/// @param margin_per_s  a stable mode decays faster than exp(-margin t)
/// @throws as SplitStable
BalancedSystem BalanceGramians(const StateSpace& system, double margin_per_s);

/// The rest and the first `order` balanced states of the stable part.
/// @throws std::invalid_argument if order is outside 0 .. states of the stable part
StateSpace Truncated(const BalancedSystem& system, int order);

/// 2 (hankel_{order+1} + ..): bound on the error of the gain from input to output at any frequency.
/// Glover 1984, Enns 1984.
double ErrorBound(const BalancedSystem& system, int order);

/// Largest singular value of C (jw - A)^-1 B.
double Gain(const StateSpace& system, double omega_rad_s);

/// The same of the difference of two systems with the same inputs and outputs.
double GainOfDifference(const StateSpace& a, const StateSpace& b, double omega_rad_s);

}  // namespace flexarm
