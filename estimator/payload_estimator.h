#pragma once

#include <array>
#include <optional>
#include <span>

#include "estimator/counter_decoder.h"
#include "estimator/delay_detector.h"
#include "estimator/estimator_config.h"
#include "estimator/payload_filter.h"
#include "estimator/piecewise_torque.h"
#include "estimator/strain_fit.h"
#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// The constants of PayloadFilter's model, for the design: a replay uses the recorded ones. Its
/// gauge filters are of first order: LagCorner_hz.
/// @returns as RigidJointStepper::Constants
std::vector<double> PayloadModelConstants(const ArmParameters& arm, const SensorConfig& sensors,
                                          double period_s);

/// The filter's settings for a rig: the noise of its encoders and gauges, the friction of its
/// joints.
/// @param config  with `payload`
PayloadFilterConfig PayloadFilterFor(const ArmParameters& arm, const SensorConfig& sensors,
                                     const EstimatorConfig& config);

/// The estimator `ekf-payload`: an extended Kalman filter (PayloadFilter) on decoded counters and
/// fitted modal coordinates, with a test for undeclared delay (DelayDetector). An input that is not
/// good is ignored in that sample. The first Update after a Reset starts at rest at the measured
/// hub angles. Real-time: all but the constructor is safe.
class PayloadEstimator {
 public:
  using State = Eigen::Matrix<double, 12, 1>;  ///< q, q' of RigidJointArm: the order of R12

  /// @param model  as PayloadModelConstants
  PayloadEstimator(std::span<const double> model, const PayloadFilterConfig& config);

  /// Also resets the estimated delay to the declared one.
  void Reset() noexcept {
    started_ = false;
    delay_.Reset();
  }

  /// @param tip_m_s2  of the accelerometer at the tip (TipReading), if it was read
  const PayloadFilter::Estimate& Update(const DecodedCounters& counters, const FittedModes& modes,
                                        const PiecewiseTorque& applied,
                                        std::optional<double> tip_m_s2 = std::nullopt) noexcept;

  /// The same with the torques of all delay hypotheses, followed by the test. If it switches to
  /// another hypothesis, the payload and friction estimates restart.
  /// @param applied  must contain the torque of the current hypothesis
  const PayloadFilter::Estimate& Update(const DecodedCounters& counters, const FittedModes& modes,
                                        const TorqueByDelay& applied,
                                        std::optional<double> tip_m_s2 = std::nullopt) noexcept;

  /// Estimated delay beyond the declared one, in samples.
  int delay_found() const noexcept { return delay_.samples(); }

  /// A move starts; PayloadFilter::BeginMove.
  void BeginMove(bool same_load) noexcept { filter_.BeginMove(same_load); }
  /// The payload is another from now on; PayloadFilter::PayloadMayChange.
  void PayloadMayChange() noexcept { filter_.PayloadMayChange(); }
  /// The readings contradict the model: resets the payload estimate to 0 kg.
  void AssumePayloadLost() noexcept { filter_.AssumePayloadLost(hypotheses_); }
  /// The arm is at rest after a move: payload and friction are not updated until the next move.
  void EndMove() noexcept { filter_.EndMove(); }

  /// Rates of the modal coordinates as the gauges read them, behind their filters, m/s: f11 f12 f21
  /// f22.
  std::array<double, 4> ModalRates() const noexcept;

  State Now() const noexcept { return StateOf(filter_.estimate().state); }
  State After(const PiecewiseTorque& torque) const noexcept {
    return StateOf(filter_.After(torque));
  }

  const PayloadFilter::Estimate& estimate() const noexcept { return filter_.estimate(); }
  double mean_nis() const noexcept { return filter_.mean_nis(); }
  const RigidJointStepper& stepper() const noexcept { return filter_.stepper(); }

 private:
  void StartAt(const DecodedCounters& counters, const FittedModes& modes) noexcept;

  static State StateOf(const GaugedState& x) noexcept {
    State out;
    out << x.q, x.v;
    return out;
  }

  PayloadFilter filter_;
  PayloadFilter::Covariance covariance_after_rest_;
  DelayDetector delay_;
  // By delay; filter_ itself is the current one.
  std::array<PayloadFilter::Hypothesis, kDelays> hypotheses_;
  bool started_ = false;
};

}  // namespace flexarm
