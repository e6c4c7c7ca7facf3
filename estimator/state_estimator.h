#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "estimator/counter_decoder.h"
#include "estimator/estimator_config.h"
#include "estimator/filter_covariance.h"
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
  Eigen::MatrixXd W, P;            ///< covariances: of the process noise, of the prediction
  Eigen::VectorXd R;               ///< variances of the outputs
};

/// State estimator of the nominal model at k Ts, from decoded counters and fitted modal
/// coordinates.
///
/// `kalman`: Kalman filter, steady-state while every sample has all outputs. A sample that lacks
/// some is corrected by the others, with the gain of exactly these (FilterCovariance). Two such
/// samples in a row are a fault (controller/step/fault_detection.h).
///
/// `difference`: coordinates as measured and backward differences, as in the thesis: the rates lag
/// by half a sample. A missing coordinate is extrapolated at its last rate; the next reading gives
/// the mean rate since the last one.
/// Real-time: all but the constructor is safe.
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
  std::array<double, 4> ModalRates(const PiecewiseTorque& applied) noexcept;

  /// @param applied  the torque over the last period, piecewise constant
  Estimate Update(const DecodedCounters& counters, const FittedModes& modes,
                  const PiecewiseTorque& applied) noexcept;
  /// The same for a torque that was constant over the period.
  Estimate Update(const DecodedCounters& counters, const FittedModes& modes,
                  const std::array<double, 2>& applied_torque_nm) noexcept {
    return Update(counters, modes, PiecewiseTorque::WholePeriod(applied_torque_nm));
  }

 private:
  using FilterVector = FilterCovariance::State;
  using FilterMatrix = FilterCovariance::Square;
  using OutputVector = FilterCovariance::Outputs;

  OutputVector Measure(const DecodedCounters& counters, const FittedModes& modes,
                       const std::array<double, 2>& torque_nm, std::uint32_t* good) const noexcept;
  void StartAtRest(const OutputVector& y) noexcept;
  const FilterVector& Predicted(const PiecewiseTorque& applied) noexcept;
  Estimate UpdateKalman(const OutputVector& y, std::uint32_t good,
                        const PiecewiseTorque& applied) noexcept;
  Estimate UpdateDifference(const OutputVector& y, std::uint32_t good) noexcept;

  EstimatorKind kind_;
  StateLayout layout_;
  int fitted_modes_;  // a link, at most those of the model
  double period_s_;
  std::array<double, 2> joint_stiffness_;
  FractionalZeroOrderHold hold_;
  FilterMatrix C_, L_;
  std::uint32_t needed_ = 0;  // bit i: output i has a sensor, and so a gain
  FilterCovariance covariance_;
  FilterMatrix modal_rate_x_, modal_rate_u_;  // rates of the last outputs, from state and torque
  FilterVector x_;                            // kalman: x(k|k) with the gauge filter's states
  FilterVector predicted_;                    // kalman: x(k+1|k) under predicted_under_
  PiecewiseTorque predicted_under_;           // empty: not predicted yet
  OutputVector y_before_;                     // difference: the last readings
  std::array<int, 8> missing_{};              // difference: samples since then
  bool started_ = false;
};

}  // namespace flexarm
