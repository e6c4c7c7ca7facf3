#include "controller/step/delay_compensation.h"

#include <algorithm>
#include <cstddef>

namespace flexarm {

void DelayCompensation::Reset() noexcept {
  asked_.Clear();
  reported_nm_ = {};
}

void DelayCompensation::TakeReport(const StepInput& input) noexcept {
  asked_.CorrectNewest(input.sampling_instant_ns + input.acted_late_ns);
  std::copy_backward(reported_nm_.begin(), reported_nm_.end() - 1, reported_nm_.end());
  reported_nm_[0] = input.applied_torque_nm;
}

// With `delay` additional samples of delay, the mean reported for an earlier sample acted over this
// one. With -1 it would be the mean of the next sample, which is not measured yet.
PiecewiseTorque DelayCompensation::Applied(const StepInput& input, int delay) const noexcept {
  const std::int64_t end_ns = input.sampling_instant_ns - delay * period_ns_;
  const PiecewiseTorque pieces = asked_.Between(end_ns - period_ns_, end_ns, period_ns_);
  return delay < 0 ? pieces : pieces.WithMean(reported_nm_[static_cast<std::size_t>(delay)]);
}

TorqueByDelay DelayCompensation::AppliedByDelay(const StepInput& input) const noexcept {
  TorqueByDelay applied;
  if (may_act_earlier_) applied[0] = Applied(input, -1);
  for (std::size_t d = kDelayAsKnown; d < kDelays; ++d) {
    applied[d] = Applied(input, static_cast<int>(d - kDelayAsKnown));
  }
  return applied;
}

PiecewiseTorque DelayCompensation::Pending(const StepInput& input, int delay) const noexcept {
  return asked_.Between(input.sampling_instant_ns - delay * period_ns_, ActsFrom(input),
                        period_ns_);
}

void DelayCompensation::Push(const StepInput& input,
                             const std::array<double, 2>& torque_nm) noexcept {
  asked_.Push(ActsFrom(input), torque_nm);
}

}  // namespace flexarm
