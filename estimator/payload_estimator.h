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

/// The constants of PayloadFilter's model, for the design: a run replays with those it was made
/// with. @returns as RigidJointStepper::Constants
std::vector<double> PayloadModelConstants(const ArmParameters& arm, const SensorConfig& sensors,
                                          double period_s);

/// The filter's settings for a rig: the noise of its encoders and gauges, the friction of its
/// joints. @param config  with `payload`
PayloadFilterConfig PayloadFilterFor(const ArmParameters& arm, const SensorConfig& sensors,
                                     const EstimatorConfig& config);

/// The estimator `ekf-payload`: PayloadFilter on decoded counters and fitted modal coordinates. An
/// input that is not good counts for nothing in that sample. The first Update after a Reset finds
/// the arm at rest where the hubs are.
/// Real-time: all but the constructor is safe.
class PayloadEstimator {
 public:
  using State = Eigen::Matrix<double, 12, 1>;  ///< q, q' of RigidJointArm: the order of R12

  /// @param model  as PayloadModelConstants
  PayloadEstimator(std::span<const double> model, const PayloadFilterConfig& config);

  /// The delay found is forgotten as well: the torques act as known.
  void Reset() noexcept {
    started_ = false;
    delay_.Reset();
  }

  /// @param tip_m_s2  of the accelerometer at the tip (TipReading), if there is a reading
  const PayloadFilter::Estimate& Update(const DecodedCounters& counters, const FittedModes& modes,
                                        const PiecewiseTorque& applied,
                                        std::optional<double> tip_m_s2 = std::nullopt) noexcept;

  /// The same with the torque of the delay that was found, and a look at whether another explains
  /// the readings better. If so, what was learnt by now is forgotten.
  /// @param applied  of the delay that was found there is one
  const PayloadFilter::Estimate& Update(const DecodedCounters& counters, const FittedModes& modes,
                                        const TorqueByDelay& applied,
                                        std::optional<double> tip_m_s2 = std::nullopt) noexcept;

  /// Beyond the known delay, in samples.
  int delay_found() const noexcept { return delay_.samples(); }

  /// A move starts: the payload may be another than before.
  void BeginMove() noexcept { filter_.BeginMove(); }
  /// The model has been contradicted.
  void AssumePayloadLost() noexcept { filter_.AssumePayloadLost(hypotheses_); }
  /// The arm has come to rest after a move.
  void EndMove() noexcept { filter_.EndMove(); }

  /// How fast the gauges' modal coordinates change, m/s: f11 f12 f21 f22 behind their filters.
  std::array<double, 4> ModalRates() const noexcept;

  State Now() const noexcept { return StateOf(filter_.estimate().state); }
  State After(const PiecewiseTorque& torque) const noexcept {
    return StateOf(filter_.After(torque));
  }

  const PayloadFilter::Estimate& estimate() const noexcept { return filter_.estimate(); }
  double mean_nis() const noexcept { return filter_.mean_nis(); }
  const RigidJointStepper& stepper() const noexcept { return filter_.stepper(); }

 private:
  void StartAt(const DecodedCounters& counters) noexcept;

  static State StateOf(const GaugedState& x) noexcept {
    State out;
    out << x.q, x.v;
    return out;
  }

  PayloadFilter filter_;
  DelayDetector delay_;
  std::array<PayloadFilter::Hypothesis, kDelays>
      hypotheses_;  // by delay; that which holds is the filter
  bool started_ = false;
};

}  // namespace flexarm
