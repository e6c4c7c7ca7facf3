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

/// What the loop knows at one sample, to be judged.
struct LoopFacts {
  const DecodedCounters* counters;
  const FittedModes* modes;
  const StateEstimator::Estimate* estimate;
  std::array<double, 2> applied_torque_nm;
  double frame_age_s;  ///< of the newest frame, at the sampling instant
  LoopMode mode;
};

/// Judges what only the loop can see: soft limits, rates, strain, sensors, estimator.
///
/// Angle, strain and jumps count in the sample that shows them; hub rate after two samples;
/// judgements of single sensors and of the estimator after `fault_ticks` samples in a row. Homing
/// (LoopMode::kRegulate) has no soft limits: they lie inside the switches, and the angle is in
/// doubt. The pluck test (kOpenLoop) does not judge sensors against each other: that is what it is
/// for, and its torque does not depend on them.
/// Real-time: safe.
class FaultDetection {
 public:
  struct Verdict {
    TripCauses faults;
    double value, limit;    ///< of the lowest fault
    std::uint16_t channel;  ///< 1-based; 0: none
    bool at_rest;           ///< hub and strain rates within their bounds for rest_time
  };

  FaultDetection(const SafetyConfig& safety, const EstimatorConfig& estimator, double period_s,
                 std::uint32_t counters_present,
                 const std::array<double, 2>& joint_stiffness_nm_per_rad);

  /// Forgets everything: what follows depends on the samples after it alone, so that a log, which
  /// begins here, replays.
  void Reset() noexcept;
  Verdict Judge(const LoopFacts& facts) noexcept;

 private:
  /// Rest is judged by the mean hub rate over this many periods: a single count of the encoder in
  /// one period is faster than the arm at rest may be.
  static constexpr std::size_t kRestWindow = 5;

  void JudgeJoints(const LoopFacts& facts) noexcept;
  void JudgeCounters(const LoopFacts& facts) noexcept;
  void JudgeStrain(const LoopFacts& facts) noexcept;
  void JudgeEstimate(const LoopFacts& facts) noexcept;
  bool JudgeRest(const LoopFacts& facts) noexcept;
  /// Counts `present` samples in a row of one judgement, and raises `cause` from the `ticks`-th on.
  void Raise(TripCause cause, bool present, int ticks, double value, double limit,
             std::size_t channel) noexcept;

  SafetyConfig safety_;
  EstimatorConfig estimator_;
  double period_s_;
  std::uint32_t counters_present_;
  std::array<double, 2> joint_stiffness_;
  int rest_ticks_needed_;
  int rest_ticks_ = 0;
  std::array<std::array<double, 2>, kRestWindow> hub_before_{};  // ring of the last hub angles
  std::size_t ring_ = 0;
  std::array<double, 2> root_strain_before_{};
  bool started_ = false;  // false: the two above hold nothing yet
  std::array<int, kTripCauses> in_a_row_{};
  Verdict verdict_{};
};

}  // namespace flexarm
