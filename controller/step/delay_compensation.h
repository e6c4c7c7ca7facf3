#pragma once

#include <array>
#include <cstdint>

#include "controller/step/actuation_queue.h"
#include "controller/types/step_types.h"
#include "estimator/delay_detector.h"
#include "estimator/piecewise_torque.h"

namespace flexarm {

/// Computes the torques that acted over the last sample, and those that will act until the torque
/// of this step does. An Observer uses the former in its time update, and the latter for the
/// open-loop prediction of the state to the instant at which the torque acts.
///
/// A torque acts some time after it is asked for. The drive side measures these instants as far as
/// it can (StepInput); the estimator adds `delay` whole samples.
/// Source: docs/theory/control-law.md 8. Real-time: safe.
class DelayCompensation {
 public:
  /// @param may_act_earlier  a period or more of delay is declared, so it may be a period less
  DelayCompensation(std::int64_t period_ns, bool may_act_earlier)
      : period_ns_(period_ns), may_act_earlier_(may_act_earlier) {}

  void Reset() noexcept;

  /// Call first in each step. Takes the instant of the newest torque and the applied mean torque.
  void TakeReport(const StepInput& input) noexcept;

  /// The torque over [k-1, k] Ts: changes at the instants of the commands, with the mean that the
  /// drive side applied.
  /// @param delay  samples by which torques act later than the drive side measures
  PiecewiseTorque Applied(const StepInput& input, int delay) const noexcept;
  /// The same for every delay hypothesis.
  TorqueByDelay AppliedByDelay(const StepInput& input) const noexcept;

  /// The torque from k Ts to the instant at which the torque of this step acts.
  PiecewiseTorque Pending(const StepInput& input, int delay) const noexcept;

  /// Call last in each step, with the torque that it asks for.
  void Push(const StepInput& input, const std::array<double, 2>& torque_nm) noexcept;

 private:
  std::int64_t ActsFrom(const StepInput& input) const noexcept {
    return input.sampling_instant_ns + period_ns_ + input.acts_late_ns;
  }

  std::int64_t period_ns_;
  bool may_act_earlier_;
  ActuationQueue asked_;
  // Means that the drive side reported, of this sample and the ones before it.
  std::array<std::array<double, 2>, kDelays - kDelayAsKnown> reported_nm_{};
};

}  // namespace flexarm
