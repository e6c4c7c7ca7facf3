#pragma once

#include <optional>
#include <span>
#include <string>

#include "controller/reference/motion_limits.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// Shares of the limits that a reference may use, 0 .. 1; of the angles it may use all.
struct LimitShares {
  double torque, jump, rate, strain;  ///< of the torque, its jump, the hub rate, the strain

  static constexpr LimitShares Of(double every) { return {every, every, every, every}; }
};

/// The first violation of a limit by a reference.
struct BrokenLimit {
  int sample;        ///< first sample beyond the limit
  std::string text;  ///< quantity, joint or link, largest value, limit
};

/// Checks a reference sample by sample against `shares` of the limits:
///
///   |th|, |th'|                     of x_m, the hubs'; the angle against the full soft limit
///   |u_m| + K_F + b |th'|           against the torque limit, with the largest friction
///   |u_m(k) - u_m(k-1)|             against the slew limit of the gate over four periods
///   |sum_j (h/2) psi_j'' f_j|       of x_m, against the strain limit
///
/// Four periods: the law passes about half of a jump of u_m immediately ((7.24): vartheta Ufu + (1
/// - vartheta) S22 = 0.50), and the gate may be late by two periods, the largest age of a command.
/// The thesis's doublets jump by 13.3 N m, 1.3 times the slew limit of one period, and run.
/// @param states  number of states of the reference model
/// @param first   number of the sample reference[0]; if above 0, this sample is not checked itself
///                and only gives the change of torque to the next
std::optional<BrokenLimit> FirstBrokenLimit(std::span<const ReferenceSample> reference, int states,
                                            const MotionLimits& limits, const LimitShares& shares,
                                            double period_s, int first = 0);

}  // namespace flexarm
