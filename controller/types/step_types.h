#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "controller/types/safety_state.h"
#include "estimator/calibration.h"
#include "hal/sensor_frame.h"
#include "model/rigid_joint/motion_sample.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

inline constexpr int kMaxNominalStates = 16;  ///< R12 uses 12 of them: estimator/state_layout.h
inline constexpr int kMaxFilterOutputs = 8;

/// State and command of the reference model at one sample.
struct ReferenceSample {
  std::array<double, 2> u_m_nm;               ///< command torque u_m held from this sample on
  std::array<double, kMaxNominalStates> x_m;  ///< state of the reference model, SI, psi(L) = 1
};

/// Source of the torque while torque is allowed. The value is logged: never renumber.
enum class LoopMode : std::uint8_t {
  kFollow = 0,    ///< the law follows the reference model; Stopping damps the arm
  kOpenLoop = 1,  ///< reference_next.u_m without feedback; Stopping: no torque
  kRegulate = 2,  ///< stop regulator towards the slow goal reference_next.x_m
};

/// All inputs of one control step: its output depends only on them and on its state since the last
/// reset.
///
/// Recorded completely before use; replay uses the same bytes again. No padding.
struct StepInput {
  std::int64_t tick;                 ///< k: the frame belongs to the sampling instant k Ts
  std::int64_t now_ns;               ///< due instant of this step, in the clock of the loop
  std::int64_t sampling_instant_ns;  ///< k Ts, in the same clock: nominal instant of the frame
  SensorFrame frame;
  std::array<double, 2> applied_torque_nm;  ///< after the gate: mean over [k-1, k] Ts
  std::int64_t acted_late_ns;  ///< torque k-1 began to act this long after k Ts, as far as is known
  std::int64_t acts_late_ns;   ///< torque k will act this long after (k+1) Ts; negative: before it
  ReferenceSample reference_now;   ///< at k Ts
  ReferenceSample reference_next;  ///< when the torque computed now acts, with the delay found
  std::array<RigidPoint, 3> path;  ///< a period before that, at it, a period after; of a path
  MotionSample plan;  ///< of the law `receding-horizon`, at that instant; see `planned`
  std::array<std::int64_t, kCounters> counts_before;  ///< unwrapped counts from before a reset
  Calibration calibration;                            ///< adopted at a reset
  SafetyState safety_state;
  std::uint8_t reset;  ///< 1: clear all state but counts_before (just armed, or calibrated)
  std::uint8_t reference_ended;  ///< 1: reference_next is the last sample of the experiment
  LoopMode mode;
  std::uint8_t planned;       ///< 1: `plan` is valid; 0: the law uses its closed form
  std::uint8_t same_load;     ///< 1: the move has the payload of the one before it
  std::uint8_t load_changes;  ///< 1: a change of the payload is announced for now
  std::uint8_t reduced;       ///< 1: the limits are reduced (WithReducedLimits)
};
static_assert(std::is_trivially_copyable_v<StepInput>);
static_assert(sizeof(StepInput) == 24 + sizeof(SensorFrame) + 32 + 2 * sizeof(ReferenceSample) +
                                       3 * sizeof(RigidPoint) + sizeof(MotionSample) +
                                       sizeof(std::int64_t) * kCounters + sizeof(Calibration) + 8,
              "no padding: the bytes are logged and compared");

/// Why the step limited the torque of the law. Bits of StepOutput::limits.
enum LimitBit : std::uint32_t {
  kLimitTorque1 = 1,
  kLimitTorque2 = 2,
  kAdaptationHeld = 4,  ///< saturated, invalid sensor, or not Running
  kPredictionOff = 8,
};

/// Result of one control step, and the internal signals behind it. No padding.
struct StepOutput {
  std::int64_t tick;
  std::uint64_t faults;  ///< TripCauses that only the loop can detect
  std::array<double, 2>
      torque_nm;  ///< requested torque, acts acts_late after (k+1) Ts; 0 unless TorqueAllowed
  std::array<double, kCounters> angle_rad;       ///< th1 th2 th3 th4 from the counters
  std::array<double, 4> modal_m;                 ///< fitted f11 f12 f21 f22
  std::array<double, kMaxNominalStates> x_hat;   ///< state at k Ts
  std::array<double, kMaxNominalStates> x_next;  ///< state predicted to the instant the torque acts
  std::array<double, kMaxFilterOutputs>
      innovation;                      ///< measurement minus prediction; 0 without filter
  std::array<double, 2> root_strain;   ///< fitted surface strain at the root of each link
  std::array<double, 2> fit_residual;  ///< rms of the strain fit, unit strain
  double adaptive_gain_change;         ///< Frobenius norm of K_I - K_I(0)
  double lyapunov_nm2;                 ///< V of the law (tracking_law.h); NaN: the law has none
  std::array<double, 2> saturated_s;   ///< time at the torque limit since the reset, per joint
  double payload_kg;                   ///< estimate; this and the next four only of `ekf-payload`
  double payload_sigma_kg;
  std::array<double, 2> friction_nm;  ///< estimated Coulomb friction
  double mean_nis;                    ///< normalised innovation squared, smoothed; 8 expected
  double fault_value;                 ///< of the lowest fault: the value that broke the limit,
  double fault_limit;                 ///< the limit,
  std::array<std::int64_t, kCounters> counts;  ///< unwrapped
  std::uint32_t limits;                        ///< LimitBit
  std::uint32_t strain_used;                   ///< bit i: strain channel i took part in the fit
  std::uint32_t counters_used;                 ///< bit i: counter i was good
  std::uint16_t
      fault_channel;     ///< and its channel (joint, counter or strain row; 1-based; 0: none)
  std::uint8_t at_rest;  ///< hub and strain rates within their bounds for rest_time
  std::uint8_t experiment_done;    ///< the reference has ended
  std::uint32_t payload_warnings;  ///< PayloadWarningBit
  std::int8_t delay_found;         ///< samples by which torques act later than known, estimated
  std::uint8_t may_damp;  ///< sensors are good enough to damp the arm after a cause of category 1
  std::array<std::uint8_t, 2> reserved;
};
static_assert(std::is_trivially_copyable_v<StepOutput>);
static_assert(sizeof(StepOutput) ==
                  16 + 8 * (2 + 4 + 4 + 2 * kMaxNominalStates + 8 + 2 + 2 + 6 + 5 + 4) + 24,
              "no padding: the bytes are logged and compared");

}  // namespace flexarm
