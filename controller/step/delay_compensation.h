#pragma once

#include <array>
#include <cstdint>

#include "controller/step/actuation_queue.h"
#include "controller/types/step_types.h"
#include "estimator/delay_detector.h"
#include "estimator/piecewise_torque.h"

namespace flexarm {

/// The torques on their way to the arm: which acted over the last sample, and which will act until
/// the torque of this step does. With them an Observer corrects for what acted, and predicts the
/// state without feedback (open loop) to the instant at which the torque acts.
///
/// A torque acts some time after it is asked for: the instants come from the drive side as far as
/// it measures them (StepInput), plus the whole samples `delay` that the estimator found. Source:
/// docs/theory/control-law.md. Real-time: safe.
class DelayCompensation {
 public:
  /// @param may_act_earlier  a delay of a period or more is declared, so it may be a period less
  DelayCompensation(std::int64_t period_ns, bool may_act_earlier)
      : period_ns_(period_ns), may_act_earlier_(may_act_earlier) {}

  void Reset() noexcept;

  /// Each step first: when the newest torque acted, and the mean that the drive side applied.
  void TakeReport(const StepInput& input) noexcept;

  /// Over [k-1, k] Ts: changes when the commands did, with the mean that the drive side applied.
  /// @param delay  samples by which torques act later than is known
  PiecewiseTorque Applied(const StepInput& input, int delay) const noexcept;
  /// The same for every delay hypothesis.
  TorqueByDelay AppliedByDelay(const StepInput& input) const noexcept;

  /// From k Ts to the instant at which the torque of this step acts.
  PiecewiseTorque Pending(const StepInput& input, int delay) const noexcept;

  /// Each step last: the torque that it asks for.
  void Push(const StepInput& input, const std::array<double, 2>& torque_nm) noexcept;

 private:
  std::int64_t ActsFrom(const StepInput& input) const noexcept {
    return input.sampling_instant_ns + period_ns_ + input.acts_late_ns;
  }

  std::int64_t period_ns_;
  bool may_act_earlier_;
  ActuationQueue asked_;
  // By the drive side, of this sample and of those before it.
  std::array<std::array<double, 2>, kDelays - kDelayAsKnown> reported_nm_{};
};

}  // namespace flexarm
