#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/problem.h"

namespace flexarm {

enum class EstimatorKind : std::uint8_t {
  kKalman,      ///< "kalman": steady state, models the gauge filter; docs/theory/control-law.md 7.3
  kDifference,  ///< "difference": rates are backward differences, as in the thesis
  kPolynomial,  ///< "polynomial": the same, on the thesis's polynomial fit (polynomial_fit.h)
  kPayload,     ///< "ekf-payload": estimates payload and friction as well (payload_filter.h)
  kIdeal,       ///< "ideal": knows the state; only `flexarm simulate` has it (ideal_observer.h)
};

/// Table [estimator.payload]: the settings of `ekf-payload`. "Walk": standard deviation of a
/// parameter's random walk per sample.
struct PayloadEstimatorConfig {
  /// Standard deviations of the generalised process forces on th1 th2 (N m) and f11 f12 f21 f22 (N,
  /// tip-normalised), held over a sample.
  std::array<double, 6> process_force;
  std::array<double, 2> rotor_extra_sigma_rad;  ///< added to the quantisation of rotor encoders
  double start_kg, start_sigma_kg;              ///< estimate before the first move
  double max_kg;                                ///< the estimate stays in 0 .. this
  double move_sigma_kg;                         ///< least standard deviation when a move begins
  double walk_kg;
  double min_rate_rad_s;  ///< with both hubs slower the payload is not updated
  std::array<double, 2> friction_start_sigma_nm;
  std::array<double, 2> friction_max_nm;
  std::array<double, 2> friction_walk_nm;
  double friction_min_rate_rad_s;  ///< the friction of a slower hub has no random walk
  double play_threshold_counts;    ///< of hub 2: a larger distance of rotor 2 is backlash
  double play_memory;              ///< share of the largest such distance kept after a sample
  double gate_sigmas;              ///< a single output beyond this is an outlier
  bool detect_delay = true;  ///< test for whole samples of undeclared delay (delay_detector.h)
  /// Of an accelerometer at the tip: model error of its reading, added to its noise.
  /// Needed with [sensors.tip_accelerometer] only.
  std::optional<double> tip_extra_sigma_m_s2{};
};

/// Section [estimator].
struct EstimatorConfig {
  EstimatorKind kind;  ///< key `name`
  int modes_per_link;  ///< modal coordinates fitted per link, 1 or 2; the model may have others
  /// Standard deviations of the Kalman filter's generalised process forces on joint 1, joint 2 (hub
  /// and rotor alike, where the model distinguishes them), f11 f12 f21 f22 (N m, N m, N x 4,
  /// tip-normalised).
  std::array<double, 6> process_force;
  std::array<double, 2> rotor_extra_sigma_rad;  ///< added to the quantisation of rotor encoders
  /// Added to the quantisation of hub encoders, also in `ekf-payload`: what a hub does beyond the
  /// model, as a fine encoder shows it.
  std::array<double, 2> hub_extra_sigma_rad;
  std::array<double, 4> modal_sigma_m;  ///< of the fitted f11 f12 f21 f22
  // Plausibility checks of the inputs.
  double max_joint_rate_rad_s;  ///< a faster change of a counter is an impossible jump
  double hub_rotor_limit_rad;   ///< |rotor - hub - u/K| beyond this is a fault
  double strain_family_limit;   ///< |channel - fit| beyond this (unit strain) is dropped
  double strain_stuck_limit;    ///< change of the fit (unit strain) while a channel is constant
  double innovation_limit_rad;  ///< hub angle innovation beyond this is a residual fault
  int fault_ticks;              ///< a check must fail this long to be a fault, 1..3
  std::optional<PayloadEstimatorConfig> payload{};  ///< needed by `ekf-payload` only

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
