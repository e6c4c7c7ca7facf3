#pragma once

#include <optional>
#include <span>
#include <string>

#include "controller/reference/motion_limits.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// The first limit that a reference breaks.
struct BrokenLimit {
  int sample;        ///< k, when it first does
  std::string text;  ///< what, of which joint or link, reaches how much: and the limit
};

/// Follows a reference sample by sample and compares with `share` of every limit:
///
///   |th|, |th'|                     of x_m, the hubs'; the angle with the whole soft limit
///   |u_m| + K_F + b |th'|           against the torque limit: friction at its worst
///   |u_m(k) - u_m(k-1)|             against what the gate lets pass in four periods
///   |sum_j (h/2) psi_j'' f_j|       of x_m, against the strain limit
///
/// Four periods: the law hands on about half of a jump of u_m at once ((7.24): vartheta Ufu +
/// (1 - vartheta) S22 = 0.50), and the gate may be late by two periods, as old as a command may be.
/// The thesis's doublets jump by 13.3 N m, 1.3 times what passes in one period, and run.
/// @param states  of the reference model
/// @param share   0 .. 1
/// @param first   number of the sample reference[0]; one beyond 0 is there for the jump of the
///                torque after it and not judged
std::optional<BrokenLimit> FirstBrokenLimit(std::span<const ReferenceSample> reference, int states,
                                            const MotionLimits& limits, double share,
                                            double period_s, int first = 0);

}  // namespace flexarm
