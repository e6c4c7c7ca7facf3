#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "controller/law/law.h"
#include "controller/law/stop_controller.h"
#include "controller/step/delay_compensation.h"
#include "controller/step/fault_detection.h"
#include "controller/step/motion_state.h"
#include "controller/types/step_types.h"
#include "estimator/counter_decoder.h"
#include "estimator/observer.h"
#include "estimator/strain_fit.h"
#include "hal/sensor_config.h"

namespace flexarm {

struct ControlConfig;
struct Design;

/// One step of the loop, from encoder counts and strains to torques (docs/architecture.md).
///
///   counts -decode-> angles, strains -fit-> modal coordinates -observe-> x(k) -predict-> x at the
///   instant at which the torque acts -law-> asked torque
///
/// The output is a function of the inputs since the last reset: no I/O, lock, allocation, clock or
/// exception, and only + - * / and sqrt, so the same input bytes give the same output bytes.
/// Real-time: `Step` is safe; the constructor is not.
class ControlStep {
 public:
  ControlStep(const ControlConfig& config, const Design& design);
  /// With another law than that of config.controller.
  ControlStep(const ControlConfig& config, const Design& design, std::unique_ptr<Law> law);
  /// With another observer than that of config.estimator.
  ControlStep(const ControlConfig& config, const Design& design,
              std::unique_ptr<Observer> observer);

  StepOutput Step(const StepInput& input) noexcept;

 private:
  ControlStep(const ControlConfig& config, const Design& design, std::unique_ptr<Law> law,
              std::unique_ptr<Observer> observer);

  enum class Phase : std::uint8_t { kNoTorque, kRunning, kStopping };

  void Reset(const StepInput& input) noexcept;
  FittedModes Fit(const SensorFrame& frame, std::int64_t instant_ns,
                  const PiecewiseTorque& applied) noexcept;
  void FollowPath(const StepInput& input) noexcept;
  void FollowReference(const StepInput& input) noexcept;
  StateEstimate Observe(const StepInput& input, const SensorFrame& frame,
                        const DecodedCounters& counters, const FittedModes& modes,
                        const PiecewiseTorque& applied) noexcept;
  /// Surface strain at the root of each link.
  /// @param modal_m  f11.. f21.., as many as the nominal model has
  std::array<double, 2> RootStrain(const double* modal_m) const noexcept;
  LawOutput Decide(const StepInput& input, const StateVector& x, bool sensors_good) noexcept;
  LawOutput Follow(const StepInput& input, const StateVector& x, bool sensors_good) noexcept;
  LawOutput Stop(const StepInput& input, const StateVector& x) noexcept;
  LawOutput OpenLoop(const StepInput& input) const noexcept;
  std::array<double, 2> ReferenceHubs(const StepInput& input) const noexcept;
  void Reduce(LawOutput* decision) const noexcept;
  void CountSaturation(std::uint32_t limits) noexcept;

  double period_s_;
  std::int64_t max_reading_age_ns_;  // half a period: beyond it another sample is nearer
  bool prediction_;
  std::array<double, 2> torque_limit_nm_, reduced_torque_nm_;
  StateLayout layout_;
  std::optional<TipAccelerometerConfig> tip_accelerometer_;
  CounterDecoder decoder_;
  StrainFit fit_;
  std::unique_ptr<Observer> observer_;
  FaultDetection fault_detection_;
  DelayCompensation delay_;
  std::unique_ptr<Law> law_;
  StopController stop_;
  MotionState motion_;
  std::array<double, 2> torque_nm_{};  // of the last step
  std::array<double, 2> saturated_s_{};
  Phase phase_ = Phase::kNoTorque;
};

}  // namespace flexarm
