#pragma once

#include <algorithm>
#include <cstdint>

#include "controller/types/step_types.h"

namespace flexarm {

/// The delay of the loop from sampling instant to torque, as the drive side measured it, and what
/// is left of the loop's delay margin. Real-time safe. Thread: operator.
class DelayMonitor {
 public:
  /// @param margin_s  delay beyond the predicted one that makes the loop unstable (screen.h)
  DelayMonitor(std::int64_t period_ns, double margin_s)
      : period_ns_(period_ns), margin_s_(margin_s) {}

  /// Every step, in order.
  /// @returns true once a run: when a torque acted so late that less than half of the margin was
  /// left
  bool Take(const StepInput& input) noexcept {
    const bool runs = input.safety_state == SafetyState::kRunning;
    if (runs && !runs_) warned_ = false;
    runs_ = runs;
    const std::int64_t beyond_ns = input.acted_late_ns - planned_late_ns_;
    planned_late_ns_ = input.acts_late_ns;
    delay_ns_ = period_ns_ + input.acted_late_ns;
    longest_ns_ = std::max(longest_ns_, delay_ns_);
    if (!known_) {  // the torque before the first step has no prediction
      known_ = true;
      return false;
    }
    beyond_ns_ = std::max(beyond_ns_, beyond_ns);
    if (!runs || warned_ || 1e-9 * static_cast<double>(beyond_ns) <= 0.5 * margin_s_) return false;
    warned_ = true;
    return true;
  }

  double delay_ms() const noexcept { return 1e-6 * static_cast<double>(delay_ns_); }
  double longest_ms() const noexcept { return 1e-6 * static_cast<double>(longest_ns_); }
  /// What is left of the margin after the largest lateness against the prediction.
  double margin_ms() const noexcept {
    return 1e3 * margin_s_ - 1e-6 * static_cast<double>(beyond_ns_);
  }

 private:
  std::int64_t period_ns_;
  double margin_s_;
  std::int64_t delay_ns_ = 0;
  std::int64_t longest_ns_ = 0;
  std::int64_t planned_late_ns_ = 0;
  std::int64_t beyond_ns_ = 0;  // the largest
  bool known_ = false;
  bool runs_ = false;
  bool warned_ = false;
};

/// Notices that the step compensates for a delay that is neither declared nor measured (delay_found
/// of StepOutput). Real-time safe. Thread: operator.
class FoundDelayMonitor {
 public:
  /// Every step, in order.
  /// @returns true once a run: when such a delay was found
  bool Take(const StepInput& input, const StepOutput& output) noexcept {
    if (input.safety_state != SafetyState::kRunning) {
      reported_ = false;
      return false;
    }
    if (reported_ || output.delay_found == 0) return false;
    reported_ = true;
    return true;
  }

 private:
  bool reported_ = false;
};

}  // namespace flexarm
