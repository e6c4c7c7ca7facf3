#pragma once

#include <gtest/gtest.h>

#include "controller/safety/safety_monitor.h"
#include "tests/support/loop_time.h"

// What the safety monitor sees of an arm, for its tests.
namespace flexarm {

inline constexpr MonitorLimits kLimits{.heartbeat_timeout_ns = 40 * kMs,
                                       .stop_timeout_ns = 3000 * kMs,
                                       .fault_stop_ns = 500 * kMs,
                                       .missed_deadlines_to_trip = 3,
                                       .homing_contact_ns = 500 * kMs,
                                       .lines_stall_ns = 5 * kMs,
                                       .overrun_ns = 5 * kMs,
                                       .missed_in_window = 16,
                                       .failed_in_window = 17,
                                       .slow_in_window = 18};

// Running for a second, without a fault.
inline SafetyInputs Fine() {
  const std::int64_t due_ns = 10'000 * kMs;
  ControlReport control = kNoControlReport;
  control.tick = 499;
  control.due_ns = due_ns - 20 * kMs;
  control.may_damp = true;
  DriveReport drive{
      .due_ns = due_ns - 1 * kMs, .bus_ok = true, .drive_ok = true, .power = DrivePower::kOn};
  return {.due_ns = due_ns,
          .levels = kHealthyLevels,
          .control = control,
          .control_alive_ns = control.due_ns,
          .drive = drive,
          .drive_alive_ns = drive.due_ns,
          .request = RequestKind::kNone,
          .state = SafetyState::kRunning,
          .state_since_ns = due_ns - 1000 * kMs,
          .running_since_ns = due_ns - 1000 * kMs,
          .may_open = 0};
}

inline void ExpectEvidence(TripCause cause, const SafetyInputs& in, double value, double limit,
                           std::uint32_t channel) {
  const Evidence evidence = SafetyMonitor(kLimits).EvidenceOf(cause, in);
  EXPECT_DOUBLE_EQ(evidence.value, value);
  EXPECT_DOUBLE_EQ(evidence.limit, limit);
  EXPECT_EQ(evidence.channel, channel);
}

}  // namespace flexarm
