#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "controller/types/safety_state.h"

namespace flexarm {

/// Tells when an unused arm has been armed for too long: safety.disarm_after_s.
/// Not real-time safe. Thread: operator.
class AutoDisarm {
 public:
  /// @param after_s  0: never
  explicit AutoDisarm(double after_s) : after_ns_(std::llround(after_s * 1e9)) {}

  /// Once a period. @returns true when the arm is to be disarmed; again every second while that was
  /// refused
  bool Follow(std::int64_t now_ns, SafetyState state) {
    if (state != SafetyState::kArmed) armed_since_ns_.reset();
    if (state != SafetyState::kArmed || after_ns_ == 0) return false;
    if (!armed_since_ns_) armed_since_ns_ = now_ns;
    if (now_ns - *armed_since_ns_ < after_ns_) return false;
    constexpr std::int64_t kAgainNs = 1'000'000'000;
    armed_since_ns_ = now_ns - after_ns_ + kAgainNs;
    return true;
  }

 private:
  std::int64_t after_ns_;  // 0: never
  std::optional<std::int64_t> armed_since_ns_;
};

}  // namespace flexarm
