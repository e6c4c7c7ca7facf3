#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "controller/types/safety_config.h"
#include "controller/types/step_types.h"
#include "controller/types/trip_cause.h"
#include "estimator/counter_decoder.h"
#include "estimator/estimator_config.h"
#include "estimator/state_estimator.h"
#include "estimator/strain_fit.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// Inputs of the fault detection at one sample.
struct LoopFacts {
  const DecodedCounters* counters;
  const FittedModes* modes;
  const StateEstimator::Estimate* estimate;
  std::array<double, 2> model_root_strain;  ///< of the links as `estimate` bends them
  std::array<double, 2> root_innovation;    ///< the fit's strain there minus the predicted one
  std::array<double, 2> applied_torque_nm;
  std::array<double, 2> reference_hub_rad;  ///< where a run wants the hubs; NaN: nowhere
  double frame_age_s;                       ///< age of the newest frame at the sampling instant
  LoopMode mode;
  bool reduced = false;  ///< StepInput::reduced
};

/// Checks of the control step: soft limits, rates, strain, sensors, estimator.
///
/// Each monitored quantity has a value or is unknown, NaN. The value is the reading; in one sample
/// that lacks a reading of any sensor it is the model's, from the estimate. The strain at a root is
/// then the last reading plus the change of the estimated strain since: the estimate has no
/// friction, and bends the links for as long as friction holds a joint against its torque. In the
/// second such sample in a row, what lacks a reading is unknown. An unknown quantity passes no
/// limit: it is a fault in that sample, under the name of the sensor that is missing.
///
/// Violations of angle and strain limits and encoder jumps are faults in the sample in which they
/// occur; hub rates after two samples, estimated or measured by the encoder alone: gauges that lead
/// the estimate astray do not hide how fast a hub turns. Faults of single sensors and of the
/// estimator are raised after `fault_ticks` samples in a row; a sample that lacks a reading is no
/// evidence that they are well again. The hub of a joint without an encoder on its rotor is
/// compared with the model alone, which soon follows a wrong reading: one innovation beyond its
/// limit is a fault at once, and so is a reading that repeats itself from one sample to the next
/// while the hub turned, as soon as the hub would be off by hub_rotor_limit. Homing
/// (LoopMode::kRegulate) has no soft limits: they lie inside the switches, and the angle is not
/// calibrated yet. The pluck test (kOpenLoop) does not compare sensors with each other: it measures
/// their agreement, and its torque does not depend on them. Real-time: safe.
class FaultDetection {
 public:
  struct Verdict {
    TripCauses faults;
    double value, limit;    ///< of the lowest fault
    std::uint16_t channel;  ///< 1-based; 0: none
    bool at_rest;           ///< hub and strain rates within their bounds for rest_time
    bool may_damp;          ///< hubs and bending are measured, and not too far beyond their limits
  };

  /// After a cause of stop category 1 the arm is damped only while hub rates and strains stay below
  /// this many times their limits. Beyond, damping does not work: a wrong sign, a broken link.
  static constexpr double kDampedTo = 1.5;
  /// The same of a hub this far beyond the soft limit in force, except in homing. How far a hub
  /// turns until it is braked does not depend on where the limit lies; with up to 0.6 kg that the
  /// design of the thesis rig did not know it is 35 degrees at most (docs/safety.md).
  static constexpr double kDampedBeyond_deg = 45.0;
  /// A reading that repeats itself is followed for so long: a hub so slow that it is not off by
  /// hub_rotor_limit then may have come to rest. A vibrating link stops its hub at once, from half
  /// a radian a second.
  static constexpr double kStandsWithin_s = 0.08;

  FaultDetection(const SafetyConfig& safety, const EstimatorConfig& estimator, double period_s,
                 const SensorConfig& sensors, const std::array<int, 2>& gauges_needed,
                 const std::array<double, 2>& joint_stiffness_nm_per_rad);

  /// Resets all state: the results depend on later samples only, so that a log, which begins at a
  /// reset, replays.
  void Reset() noexcept;
  Verdict Judge(const LoopFacts& facts) noexcept;

 private:
  /// The arm is at rest by the mean hub rate over a window: one encoder count in one period already
  /// exceeds the bound on the rate at rest. Longest window, in samples: 0.1 s at 500 Hz, with room.
  static constexpr std::size_t kMostRestWindow = 64;

  /// What the limits are compared with.
  struct Monitored {
    std::array<double, 2> hub_rad, root_strain;
    std::array<double, 2> hub_rate_rad_s;  ///< at least 0; NaN if the estimate is
  };
  /// A complete sample, for the rates of the samples after it.
  struct Posture {
    std::array<double, 2> hub_rad, root_strain;
    std::int64_t tick;
  };
  /// The reading of a hub encoder that repeats itself.
  struct Repeated {
    double reading_rad = std::numeric_limits<double>::quiet_NaN();
    // In the sample before the first repeated one; the model's for that one, if it is less.
    double turned_rad = 0.0;
    int samples = 0;  // repeated, up to stands_window_
  };
  Monitored Monitor(const LoopFacts& facts) noexcept;
  /// `reading`, or what stands for it in this sample.
  double Bridged(bool read, double reading, double model) const noexcept;

  void JudgeJoints(const LoopFacts& facts, const Monitored& monitored) noexcept;
  void JudgeCounters(const LoopFacts& facts) noexcept;
  void JudgeStrain(const LoopFacts& facts) noexcept;
  void JudgeEstimate(const LoopFacts& facts) noexcept;
  /// No encoder on the rotor of joint i.
  bool IsAlone(std::size_t i) const noexcept { return (counters_present_ >> (i + 2) & 1U) == 0; }
  /// @returns how far a hub whose reading repeats itself has turned since, if it went on, rad; 0
  ///   if it does not, or not for fault_ticks yet
  double FollowRepeated(const LoopFacts& facts, std::size_t i) noexcept;
  bool JudgeRest(const LoopFacts& facts) noexcept;
  /// The complete sample so many before the present one.
  const Posture& Before(std::size_t samples) const noexcept {
    return before_[(ring_ + kMostRestWindow - samples) % kMostRestWindow];
  }
  /// The greater one of the estimated and the measured rate of a hub.
  double HubRate(const LoopFacts& facts, std::size_t i) const noexcept;
  bool MayDamp(const LoopFacts& facts, const Monitored& monitored) const noexcept;
  /// Counts the samples in a row with `present`, and raises `cause` from the `ticks`-th on. A
  /// sample that cannot tell, known = false, leaves the count, and the cause, as they are.
  void Raise(TripCause cause, bool present, int ticks, double value, double limit,
             std::size_t channel, bool known = true) noexcept;
  /// The sample lacks no reading.
  bool IsComplete() const noexcept { return incomplete_ticks_ == 0; }
  /// Raises `beyond` unless value <= limit, or `unknown` if the value is NaN.
  void RaiseUnlessWithin(TripCause beyond, TripCause unknown, int ticks, double value, double limit,
                         std::size_t joint) noexcept;

  SafetyConfig safety_, reduced_;  // with the full limits, and with the reduced ones
  EstimatorConfig estimator_;
  double period_s_;
  std::uint32_t counters_present_;
  std::array<int, 2> gauges_needed_;
  std::array<double, 2> joint_stiffness_;
  std::array<double, 2> hub_count_rad_;     // one count of the hub encoders
  std::size_t hub_window_, strain_window_;  // samples over which the rates at rest are taken
  std::size_t rate_window_;                 // samples over which a hub rate is measured
  int stands_window_;                       // samples of kStandsWithin_s, at least fault_ticks
  int rest_ticks_needed_;
  int rest_ticks_ = 0;
  int incomplete_ticks_ = 0;  // samples in a row that lacked a reading, up to kMissingTicks
  std::array<Posture, kMostRestWindow> before_{};     // ring buffer of the last complete samples
  std::size_t ring_ = 0;                              // the oldest
  std::int64_t ticks_ = 0;                            // samples since Reset
  bool started_ = false;                              // false: before_ is not set yet
  std::array<std::uint8_t, kTripCauses> in_a_row_{};  // samples with the cause, saturated
  // The last reading of the strain at the root of each link, minus the estimated one.
  std::array<double, 2> strain_off_model_{};
  // Of each link, the root innovation when its gauges last did not all repeat themselves.
  std::array<double, 2> live_innovation_{};
  std::array<Repeated, 2> repeated_{};
  Verdict verdict_{};
};

}  // namespace flexarm
