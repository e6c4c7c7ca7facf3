#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace flexarm {

/// The middle of a piece of a path q(s): what is needed to find the fastest motion over the path.
///
/// Torques along the path: u = a s'' + b s'^2.
struct PathPiece {
  Eigen::Vector2d a;             ///< M(q) dq/ds, N m s^2 per unit of s
  Eigen::Vector2d b;             ///< of the velocities, and of the path's curvature
  double largest_speed_squared;  ///< s'^2 permitted by the rates, per s^2
};

/// Time-optimal path parametrisation: the largest z = s'^2 at every point, from rest to rest.
///
/// With s'' constant over a piece, z changes by 2 ds s'', and is z + ds s'' in its middle, where
/// the limits hold. Backwards: the largest z at each piece's begin from which its end is reached
/// within the limits; forwards: the largest z reached. Both are exact: each limit bounds s'' by a
/// line over z, and two lines cross once. z = 0 everywhere is possible, so there is always a
/// solution. The error is of the order of ds^2. Source: Bobrow, Dubowsky and Gibson 1985; the two
/// passes: Pham and Pham 2018 (TOPP-RA).
/// @param pieces     of equal length `step`, one or more
/// @param torque_nm  limits, +-, > 0
/// @returns  z between the pieces and at both ends, where it is 0
std::vector<double> FastestSquaredSpeeds(std::span<const PathPiece> pieces, double step,
                                         const std::array<double, 2>& torque_nm);

/// Instant of every value of FastestSquaredSpeeds, s.
std::vector<double> TimesOver(std::span<const double> squared_speeds, double step);

}  // namespace flexarm
