#pragma once

#include <cstdint>

namespace flexarm {

/// States of the safety state machine (docs/safety.md). The value is logged: never renumber.
enum class SafetyState : std::uint8_t {
  kStarting = 0,       ///< until every task has reported once
  kIdle = 1,           ///< relay open
  kArmed = 2,          ///< relay closed, drives on, zero torque
  kRunning = 3,        ///< the experiment
  kStopping = 4,       ///< the controller damps the motion of the arm
  kTripped = 5,        ///< latched: relay open, zero torque
  kFaultStopping = 6,  ///< a cause has latched; the controller damps the arm before Tripped
  kDisarming = 7,      ///< the drives are being switched off, then the relay opens
  // Arming with a witness of the power path tests each channel of it; the drives are off:
  kTestingPump = 8,    ///< the charge pump alone
  kTestingRelay = 9,   ///< the relay alone
  kTestingPower = 10,  ///< both
};
inline constexpr int kSafetyStates = 11;

/// Torque is allowed only in these states.
constexpr bool TorqueAllowed(SafetyState state) noexcept {
  return state == SafetyState::kRunning || state == SafetyState::kStopping ||
         state == SafetyState::kFaultStopping;
}

/// The drives are enabled only in these states.
constexpr bool DrivesEnabled(SafetyState state) noexcept {
  return state == SafetyState::kArmed || TorqueAllowed(state);
}

/// The tests of the power path, which precede Armed.
constexpr bool TestsPower(SafetyState state) noexcept {
  return state == SafetyState::kTestingPump || state == SafetyState::kTestingRelay ||
         state == SafetyState::kTestingPower;
}

/// The relay is closed only in these states.
constexpr bool RelayClosed(SafetyState state) noexcept {
  return DrivesEnabled(state) || state == SafetyState::kDisarming ||
         state == SafetyState::kTestingRelay || state == SafetyState::kTestingPower;
}

/// The charge pump toggles only in these states.
constexpr bool PumpRuns(SafetyState state) noexcept {
  return DrivesEnabled(state) || state == SafetyState::kDisarming ||
         state == SafetyState::kTestingPump || state == SafetyState::kTestingPower;
}

/// A trip cause is latched in these states, and only in these.
constexpr bool CauseLatched(SafetyState state) noexcept {
  return state == SafetyState::kTripped || state == SafetyState::kFaultStopping;
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
    case SafetyState::kFaultStopping:
      return "FaultStopping";
    case SafetyState::kDisarming:
      return "Disarming";
    case SafetyState::kTestingPump:
      return "TestingPump";
    case SafetyState::kTestingRelay:
      return "TestingRelay";
    case SafetyState::kTestingPower:
      return "TestingPower";
  }
  return "corrupted";
}

}  // namespace flexarm
