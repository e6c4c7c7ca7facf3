#pragma once

#include <cstdint>

namespace flexarm {

/// States of the safety state machine (docs/safety.md). The value is logged: never renumber.
enum class SafetyState : std::uint8_t {
  kStarting = 0,  ///< until every task has reported once
  kIdle = 1,      ///< relay open
  kArmed = 2,     ///< relay closed, zero torque
  kRunning = 3,   ///< the experiment
  kStopping = 4,  ///< the controller damps the motion of the arm
  kTripped = 5,   ///< latched: relay open, zero torque
};

/// Torque is allowed only in these states.
constexpr bool TorqueAllowed(SafetyState state) noexcept {
  return state == SafetyState::kRunning || state == SafetyState::kStopping;
}

/// The relay is closed and the drives are enabled only in these states.
constexpr bool Powered(SafetyState state) noexcept {
  return state == SafetyState::kArmed || TorqueAllowed(state);
}

constexpr const char* ToString(SafetyState state) noexcept {
  switch (state) {
    case SafetyState::kStarting:
      return "Starting";
    case SafetyState::kIdle:
      return "Idle";
    case SafetyState::kArmed:
      return "Armed";
    case SafetyState::kRunning:
      return "Running";
    case SafetyState::kStopping:
      return "Stopping";
    case SafetyState::kTripped:
      return "Tripped";
  }
  return "corrupted";
}

}  // namespace flexarm
