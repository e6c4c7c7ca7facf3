#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/problem.h"

namespace flexarm {

enum class EstimatorKind : std::uint8_t {
  kKalman,      ///< "kalman": steady-state filter, gauge filter in its model (control.md section 4)
  kDifference,  ///< "difference": rates are backward differences, as in the thesis
  kPolynomial,  ///< "polynomial": the same, on the thesis's polynomial fit (polynomial_fit.h)
};

/// Section [estimator].
struct EstimatorConfig {
  EstimatorKind kind;  ///< key `name`
  int modes_per_link;  ///< modal coordinates fitted a link, 1 or 2; the model may use fewer
  /// Standard deviations of the Kalman filter's generalised process forces on joint 1, joint 2 (hub
  /// and rotor alike, where the model tells them apart), f11 f12 f21 f22 (N m, N m, N x 4,
  /// tip-normalised).
  std::array<double, 6> process_force;
  std::array<double, 2> rotor_extra_sigma_rad;  ///< added to the quantisation of rotor encoders
  std::array<double, 4> modal_sigma_m;          ///< of the fitted f11 f12 f21 f22
  // Judgement of the inputs.
  double max_joint_rate_rad_s;  ///< a faster change of a counter is an impossible jump
  double hub_rotor_limit_rad;   ///< |rotor - hub - u/K| beyond this is a fault
  double strain_family_limit;   ///< |channel - fit| beyond this (unit strain) is dropped
  double strain_stuck_limit;    ///< fit moves by this (unit strain), a channel by nothing
  double innovation_limit_rad;  ///< hub angle innovation beyond this is a residual fault
  int fault_ticks;              ///< a judgement must persist this long to be a fault, 1..3

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
