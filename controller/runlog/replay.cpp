#include "controller/runlog/replay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "controller/realtime/float_environment.h"
#include "controller/runlog/record_blocks.h"

namespace flexarm {
namespace {

// A NaN on one side only counts as an infinite difference: std::max would ignore a NaN.
double Difference(double a, double b) {
  if (std::isnan(a) && std::isnan(b)) return 0;
  const double difference = std::abs(a - b);
  return std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference;
}

}  // namespace

Replay::Replay(StepFunction step, bool other_config) : step_(std::move(step)) {
  if (!other_config) return;
  result_.bit_exact.reset();
  result_.estimate_difference.reset();
}

void Replay::Tick(const TickRecord& record) {
  const std::int64_t tick = record.input.tick;
  if (previous_tick_ && tick != *previous_tick_ + 1 && !result_.first_gap_tick) {
    result_.first_gap_tick = *previous_tick_ + 1;
  }
  previous_tick_ = tick;
  ++result_.ticks;
  reset_seen_ = reset_seen_ || record.input.reset != 0;
  if (!reset_seen_) {
    ++result_.ticks_before_reset;
    return;
  }

  const FlushDenormals flush;  // as in the control thread: equal bytes need equal arithmetic
  const StepOutput output = step_(record.input);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    double& largest = result_.max_torque_difference_nm[joint];
    largest =
        std::max(largest, Difference(output.torque_nm[joint], record.output.torque_nm[joint]));
    innovation_square_[joint] += output.innovation[joint] * output.innovation[joint];
  }
  for (std::size_t i = 0; i < kMaxNominalStates; ++i) {
    const double recorded = record.output.x_hat[i];
    largest_state_[i] = std::max(largest_state_[i], std::abs(recorded));
    largest_state_difference_[i] =
        std::max(largest_state_difference_[i], Difference(output.x_hat[i], recorded));
  }
  if (output.faults != 0) ++result_.faulty_ticks;
  if (IsOutputOf(record, output)) return;
  if (result_.bit_exact) result_.bit_exact = false;
  if (!result_.first_different_tick) result_.first_different_tick = tick;
}

void Replay::Safety(const SafetyRecord& record) {
  ++result_.safety_records;
  const bool continues = !previous_status_ || *previous_status_ == record.before;
  previous_status_ = record.after;
  const SafetyDecision recorded{.status = record.after, .refusal = record.refusal};
  if (continues && NextSafetyState(record.before, record.facts) == recorded) return;
  result_.safety_exact = false;
  if (!result_.first_different_safety_ns) result_.first_different_safety_ns = record.due_ns;
}

ReplayResult Replay::Result() const {
  ReplayResult result = result_;
  if (result.safety_records == 0) result.safety_exact.reset();
  if (!reset_seen_) {
    result.bit_exact.reset();
    result.estimate_difference.reset();
  }
  for (std::size_t i = 0; i < kMaxNominalStates && result.estimate_difference; ++i) {
    if (largest_state_difference_[i] == 0) continue;
    result.estimate_difference =
        std::max(*result.estimate_difference, largest_state_difference_[i] / largest_state_[i]);
  }
  const std::int64_t compared = result.ticks - result.ticks_before_reset;
  for (std::size_t joint = 0; joint < 2 && compared > 0; ++joint) {
    result.hub_innovation_rms_rad[joint] =
        std::sqrt(innovation_square_[joint] / static_cast<double>(compared));
  }
  return result;
}

}  // namespace flexarm
