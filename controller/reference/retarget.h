#pragma once

#include <array>

#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// Retargeting: motion from a moving state `from` to rest at `to_rad`, `time_s` after `from`.
///
/// The unique polynomial of degree seven with Y, Y', Y'' and Y''' of `from` at x = 0, x = t / T,
/// and Y = to, Y' = Y'' = Y''' = 0 at x = 1. With w = 1 - x:
///
///   Y = to + w^4 (c0 + c1 x + c2 x^2 + c3 x^3)
///
/// where the c are the first Taylor coefficients of (Y - to) (1 - x)^-4 = (Y - to) (1 + 4 x + 10
/// x^2 + 20 x^3 + ..) at 0. From rest it is the septic profile (motion_profile.h). It may overshoot
/// either end: an arm that moves away from the target has to turn round.
/// Source: docs/theory/payload.md 3.2. Real-time: safe.
/// @param duration_s  T, > 0
/// @param time_s      t; beyond 0 .. T it is `from`, or rest at the end
RigidPoint SepticToRest(const RigidPoint& from, const std::array<double, 2>& to_rad,
                        double duration_s, double time_s) noexcept;

}  // namespace flexarm
