#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "estimator/counter_decoder.h"
#include "estimator/estimator_config.h"
#include "estimator/fractional_zero_order_hold.h"
#include "estimator/piecewise_torque.h"
#include "estimator/state_estimate.h"
#include "estimator/state_layout.h"
#include "estimator/strain_fit.h"

namespace flexarm {

/// The part of the off-line design that the estimator uses (estimator/kalman_design.h).
struct FilterGains {
  StateLayout layout;
  Eigen::MatrixXd A, B, C, L;
  Eigen::MatrixXd A_rate, B_rate;  ///< continuous, for the fractions of a period
};

/// State estimator of the nominal model at k Ts, from decoded counters and fitted modal
/// coordinates.
///
/// `kalman`: steady-state Kalman filter; an input that is not good does not change the state (its
/// gain column is skipped). `difference`: coordinates as measured and backward differences, as in
/// the thesis: the rates lag by half a sample.
/// Real-time: Reset and Update are safe.
class StateEstimator {
 public:
  using Estimate = StateEstimate;

  /// @param joint_stiffness_nm_per_rad  K1, K2: with rigid joints, rotor angles are corrected by
  /// u/K
  StateEstimator(const EstimatorConfig& config, const FilterGains& gains, double period_s,
                 const std::array<double, 2>& joint_stiffness_nm_per_rad);

  /// The next Update starts from its measurement, at rest.
  void Reset() noexcept;

  /// Predicted rates of the modal coordinates as the gauges read them, behind their filters, at the
  /// next Update's sample, m/s: f11 f12 f21 f22. For `difference` the rates of the last Update.
  std::array<double, 4> ModalRates(const PiecewiseTorque& applied) const noexcept;

  /// @param applied  the torque over the last period, piecewise constant
  Estimate Update(const DecodedCounters& counters, const FittedModes& modes,
                  const PiecewiseTorque& applied) noexcept;
  /// The same for a torque that was constant over the period.
  Estimate Update(const DecodedCounters& counters, const FittedModes& modes,
                  const std::array<double, 2>& applied_torque_nm) noexcept {
    return Update(counters, modes, PiecewiseTorque::WholePeriod(applied_torque_nm));
  }

 private:
  using FilterVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 24, 1>;
  using FilterMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 24, 24>;
  using OutputVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;

  OutputVector Measure(const DecodedCounters& counters, const FittedModes& modes,
                       const std::array<double, 2>& torque_nm, std::uint32_t* good) const noexcept;
  void StartAtRest(const OutputVector& y) noexcept;
  Estimate UpdateKalman(const OutputVector& y, std::uint32_t good,
                        const PiecewiseTorque& applied) noexcept;
  Estimate UpdateDifference(const OutputVector& y, std::uint32_t good) noexcept;

  EstimatorKind kind_;
  StateLayout layout_;
  double period_s_;
  std::array<double, 2> joint_stiffness_;
  FractionalZeroOrderHold hold_;
  FilterMatrix C_, L_;
  FilterMatrix modal_rate_x_, modal_rate_u_;  // rates of the last outputs, from state and torque
  FilterVector x_;                            // kalman: x(k|k) with the gauge filter's states
  OutputVector y_before_;                     // difference
  bool started_ = false;
};

}  // namespace flexarm
