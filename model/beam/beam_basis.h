#pragma once

#include <array>

namespace flexarm {

/// Four independent solutions of f'''' = beta^4 f on a section of length l.
///
/// Short sections (beta l < 2): Krylov's functions S, T, U, V of beta x, from their series, which
/// have no cancellation. Long ones: cos, sin, exp(-beta x), exp(-beta (l - x)), which do not
/// overflow and stay independent where cosh and sinh agree to all digits.
/// @param order  derivative, 0..3
/// @returns the derivatives divided by beta^order, dimensionless
std::array<double, 4> BeamBasis(bool decaying, double beta_per_m, double length_m, double x_m,
                                int order);

/// The basis that is well conditioned for a section of this beta*l.
inline bool UseDecayingBasis(double beta_length) { return beta_length >= 2.0; }

}  // namespace flexarm
