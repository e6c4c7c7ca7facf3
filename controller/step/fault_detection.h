#pragma once

#include <array>
#include <cstdint>

#include "controller/types/safety_config.h"
#include "controller/types/step_types.h"
#include "controller/types/trip_cause.h"
#include "estimator/counter_decoder.h"
#include "estimator/estimator_config.h"
#include "estimator/state_estimator.h"
#include "estimator/strain_fit.h"

namespace flexarm {

/// Inputs of the fault detection at one sample.
struct LoopFacts {
  const DecodedCounters* counters;
  const FittedModes* modes;
  const StateEstimator::Estimate* estimate;
  std::array<double, 2> applied_torque_nm;
  double frame_age_s;  ///< age of the newest frame at the sampling instant
  LoopMode mode;
};

/// Checks of the control step: soft limits, rates, strain, sensors, estimator.
///
/// Violations of angle and strain limits and encoder jumps are faults in the sample in which they
/// occur; hub rates after two samples; faults of single sensors and of the estimator after
/// `fault_ticks` samples in a row. Homing (LoopMode::kRegulate) has no soft limits: they lie inside
/// the switches, and the angle is not calibrated yet. The pluck test (kOpenLoop) does not compare
/// sensors with each other: it measures their agreement, and its torque does not depend on them.
/// Real-time: safe.
class FaultDetection {
 public:
  struct Verdict {
    TripCauses faults;
    double value, limit;    ///< of the lowest fault
    std::uint16_t channel;  ///< 1-based; 0: none
    bool at_rest;           ///< hub and strain rates within their bounds for rest_time
    bool may_damp;  ///< hubs and bending of both links are measured, and within kDampedTo limits
  };

  /// After a cause of stop category 1 the arm is damped only while hub rates and strains stay below
  /// this many times their limits. Beyond, damping does not work: a wrong sign, a broken link.
  static constexpr double kDampedTo = 1.5;

  FaultDetection(const SafetyConfig& safety, const EstimatorConfig& estimator, double period_s,
                 std::uint32_t counters_present, const std::array<std::uint32_t, 2>& gauges,
                 const std::array<double, 2>& joint_stiffness_nm_per_rad);

  /// Resets all state: the results depend on later samples only, so that a log, which begins at a
  /// reset, replays.
  void Reset() noexcept;
  Verdict Judge(const LoopFacts& facts) noexcept;

 private:
  /// The arm is at rest by the mean hub rate over this many periods: one encoder count in one
  /// period already exceeds the bound on the rate at rest.
  static constexpr std::size_t kRestWindow = 5;

  void JudgeJoints(const LoopFacts& facts) noexcept;
  void JudgeCounters(const LoopFacts& facts) noexcept;
  void JudgeStrain(const LoopFacts& facts) noexcept;
  void JudgeEstimate(const LoopFacts& facts) noexcept;
  bool JudgeRest(const LoopFacts& facts) noexcept;
  bool MayDamp(const LoopFacts& facts) const noexcept;
  /// Counts the samples in a row with `present`, and raises `cause` from the `ticks`-th on.
  void Raise(TripCause cause, bool present, int ticks, double value, double limit,
             std::size_t channel) noexcept;

  SafetyConfig safety_;
  EstimatorConfig estimator_;
  double period_s_;
  std::uint32_t counters_present_;
  std::array<std::uint32_t, 2> gauges_;  // StrainFit::gauges
  std::array<double, 2> joint_stiffness_;
  int rest_ticks_needed_;
  int rest_ticks_ = 0;
  std::array<std::array<double, 2>, kRestWindow>
      hub_before_{};  // ring buffer of the last hub angles
  std::size_t ring_ = 0;
  std::array<double, 2> root_strain_before_{};
  bool started_ = false;  // false: the two above are not set yet
  std::array<int, kTripCauses> in_a_row_{};
  Verdict verdict_{};
};

}  // namespace flexarm
