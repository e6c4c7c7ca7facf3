#include <gtest/gtest.h>

#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

// Trips: cause, reaction time and latch.

namespace flexarm {
namespace {

using enum SafetyState;

TEST_F(SafetyTaskTest, ATripFromBeforeTheStartIsLatchedFromTheFirstTick) {
  const Evidence evidence{.value = 1.6, .limit = 1.5, .channel = 2, .detail = 0};
  const SafetyStatus tripped{kTripped, TripCause::kSoftLimit2};
  safety_.StartTripped(TripCause::kSoftLimit2, evidence);
  lines_.levels = kHealthyLevels | LineBit(Line::kResetButton);  // held from the start: counts not
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kWrongState);
  EXPECT_EQ(permit().state, kTripped);
  EXPECT_EQ(permit().cause, TripCause::kSoftLimit2);
  EXPECT_EQ(permit().evidence.value, 1.6);
  EXPECT_EQ(permit().evidence.channel, 2u);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kUnhealthy) << "not every task has reported";
  RunFor(100 * kMs);
  EXPECT_EQ(safety_.status(), tripped) << "though every task has reported";
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kWrongState);
  EXPECT_EQ(Now(RequestKind::kRun), Refusal::kWrongState);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNoReset);
  lines_.levels = kHealthyLevels;
  RunFor(kMs);
  lines_.levels = kHealthyLevels | LineBit(Line::kResetButton);
  RunFor(LineFilter::kPressNs);
  lines_.levels = kHealthyLevels;
  control_.report.at_rest = false;
  RunFor(50 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNotAtRest);
  control_.report.at_rest = true;
  RunFor(50 * kMs);
  for (const FakeLines::Written& written : lines_.written) {
    EXPECT_FALSE(written.outputs.relay_closed);
    EXPECT_FALSE(written.outputs.pump_level);
  }
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNone);
  EXPECT_EQ(safety_.status().state, kIdle);
  GoTo(kRunning);
  // The records describe the whole run, from the trip on: replay repeats them.
  const std::vector<SafetyRecord> records = Records();
  EXPECT_EQ(records.front().before, tripped);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const SafetyDecision decision{.status = records[i].after, .refusal = records[i].refusal};
    EXPECT_EQ(NextSafetyState(records[i].before, records[i].facts), decision) << i;
    if (i > 0) {
      EXPECT_EQ(records[i].before, records[i - 1].after) << i;
    }
  }
}

TEST_F(SafetyTaskTest, EverySwitchOpensTheRelayAtItsSecondSampleAndZeroesTheTorqueWithinThreeMs) {
  const struct {
    Line line;
    TripCause cause;
  } cases[] = {{Line::kLimit1Low, TripCause::kLimitSwitch1Low},
               {Line::kLimit1High, TripCause::kLimitSwitch1High},
               {Line::kLimit2Low, TripCause::kLimitSwitch2Low},
               {Line::kLimit2High, TripCause::kLimitSwitch2High},
               {Line::kEmergencyStop, TripCause::kEmergencyStop}};
  bool first = true;
  for (const auto& c : cases) {
    SCOPED_TRACE(ToString(c.cause));
    if (first) {
      GoTo(kRunning);
      first = false;
    } else {  // after the last trip
      lines_.levels = kHealthyLevels | LineBit(Line::kResetButton);
      control_.report.at_rest = true;
      RunFor(100 * kMs);
      lines_.levels = kHealthyLevels;
      RunFor(kMs);
      ASSERT_EQ(Now(RequestKind::kReset), Refusal::kNone);
      GoTo(kRunning);
    }
    const std::int64_t opened_ns = executor_.next_ns();
    lines_.levels &= ~LineBit(c.line);
    RunFor(kMs);  // the first tick at which the level is open, up to 1 ms after the contact
    EXPECT_EQ(safety_.status().state, kRunning) << "one sample may be interference";
    RunFor(kMs);
    EXPECT_EQ(lines_.written.back().now_ns, opened_ns + kMs);
    EXPECT_FALSE(lines_.relay_closed());
    EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, c.cause}));
    RunFor(kMs);  // the drive's next tick
    EXPECT_EQ(drive_.torque_nm[0], 0.0);
    EXPECT_EQ(drive_.torque_nm[1], 0.0);
    EXPECT_EQ(permit().cause, c.cause);
    EXPECT_EQ(permit().evidence.limit, 1.0);
    lines_.levels |= LineBit(c.line);
    RunFor(1000 * kMs);
    EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, c.cause}))
        << "latched, though the switch closed";
  }
}

// Stopped at each millisecond of a period: the torque always ends within two periods and 2 ms.
TEST_F(SafetyTaskTest, AStoppedControlThreadEndsTheTorqueWithinTwoPeriodsAndTwoMs) {
  GoTo(kRunning);
  for (int offset_ms = 0; offset_ms < 20; ++offset_ms) {
    SCOPED_TRACE(offset_ms);
    RunFor(kPeriodNs + kMs);
    ASSERT_EQ(drive_.torque_nm[0], 1.0);
    // No activation due at next_ns() or later runs: the thread stopped just before.
    const std::int64_t stopped_ns = executor_.next_ns();
    control_.stopped = true;
    const std::int64_t tripped_ns = RunUntilTripped(1000 * kMs);
    EXPECT_EQ(safety_.status().cause, TripCause::kControlHeartbeatLost);
    EXPECT_GT(permit().evidence.value, 0.040);
    EXPECT_EQ(permit().evidence.limit, 0.040);
    RunFor(kMs);
    EXPECT_EQ(drive_.torque_nm[0], 0.0) << "at the drive's tick after the trip";
    EXPECT_LE(tripped_ns + kMs, stopped_ns + 2 * kPeriodNs + 2 * kMs);

    control_.stopped = false;
    control_.report.at_rest = true;
    lines_.levels |= LineBit(Line::kResetButton);
    RunFor(100 * kMs);
    lines_.levels = kHealthyLevels;
    ASSERT_EQ(safety_.status().state, kTripped) << "it runs again, without arming";
    ASSERT_EQ(Now(RequestKind::kReset), Refusal::kNone);
    GoTo(kRunning);
    // One millisecond later each round.
    while ((executor_.next_ns() / kMs) % 20 != offset_ms) RunFor(kMs);
  }
}

TEST_F(SafetyTaskTest, OneSkippedPeriodOfTheControlThreadDoesNotTrip) {
  GoTo(kRunning);
  while (executor_.next_ns() % kPeriodNs != kPhaseNs) RunFor(kMs);
  control_.stopped = true;
  RunFor(kMs);
  control_.stopped = false;
  RunFor(200 * kMs);
  EXPECT_EQ(safety_.status().state, kRunning);
}

TEST_F(SafetyTaskTest, AFrozenDriveSideTripsAsAStaleFrameWithinTwoPeriodsAndTwoMs) {
  GoTo(kRunning);
  const std::int64_t frozen_ns = executor_.next_ns();
  drive_.stopped = true;
  const std::int64_t tripped_ns = RunUntilTripped(1000 * kMs);
  EXPECT_LE(tripped_ns, frozen_ns + 2 * kPeriodNs + 2 * kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kStaleFrame);
  EXPECT_FALSE(lines_.relay_closed());
  drive_.stopped = false;
  RunFor(2 * kMs);
  EXPECT_EQ(drive_.torque_nm[0], 0.0) << "tripped when it runs again";
  RunFor(1000 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kStaleFrame}));
}

TEST_F(SafetyTaskTest, ALostBusAndADriveFaultTripWhenTheReportIsValid) {
  GoTo(kRunning);
  drive_.report.drive_ok = false;
  const std::int64_t reported_ns = executor_.next_ns();
  EXPECT_EQ(RunUntilTripped(10 * kMs), reported_ns + kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kDriveFault);
  drive_.report.bus_ok = false;
  RunFor(10 * kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kDriveFault) << "the first cause stays";
}

TEST_F(SafetyTaskTest, AFaultOfTheLoopTripsWithItsEvidenceWhenTheReportIsValid) {
  GoTo(kRunning);
  control_.report.faults =
      CauseBit(TripCause::kSoftLimit2) | CauseBit(TripCause::kEstimatorResidual);
  control_.report.evidence = {.value = 1.6, .limit = 1.57, .channel = 2, .detail = 0};
  const std::int64_t tripped_ns = RunUntilTripped(100 * kMs);
  EXPECT_EQ((tripped_ns - kPhaseNs) % kPeriodNs, kDeadlineNs);
  EXPECT_EQ(permit().cause, TripCause::kSoftLimit2);
  EXPECT_EQ(permit().evidence.value, 1.6);
  EXPECT_EQ(permit().evidence.limit, 1.57);
  EXPECT_EQ(permit().evidence.channel, 2u);
}

TEST_F(SafetyTaskTest, StoppingLongerThanAllowedTripsThreeSecondsAfterTheStop) {
  GoTo(kRunning);
  const std::int64_t stopped_ns = executor_.next_ns();
  ASSERT_EQ(Now(RequestKind::kStop), Refusal::kNone);
  EXPECT_EQ(RunUntilTripped(4000 * kMs), stopped_ns + 3001 * kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kStopTimeout);
  EXPECT_DOUBLE_EQ(permit().evidence.value, 3.001);
  EXPECT_DOUBLE_EQ(permit().evidence.limit, 3.0);
}

TEST_F(SafetyTaskTest, NoArmingWithoutRequestAndResetNeedsButtonAndOperator) {
  GoTo(kRunning);
  lines_.levels &= ~LineBit(Line::kEmergencyStop);
  RunFor(2 * kMs);
  ASSERT_EQ(safety_.status().state, kTripped);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kCauseRemains);
  lines_.levels |= LineBit(Line::kEmergencyStop);
  RunFor(kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNoReset);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kWrongState);
  lines_.levels |= LineBit(Line::kResetButton);
  RunFor(49 * kMs);
  lines_.levels &= ~LineBit(Line::kResetButton);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNoReset) << "a press is 50 ms long";
  lines_.levels |= LineBit(Line::kResetButton);
  RunFor(50 * kMs);
  lines_.levels &= ~LineBit(Line::kResetButton);
  RunFor(10'000 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kEmergencyStop}));
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNotAtRest);
  control_.report.at_rest = true;
  RunFor(40 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNone);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kIdle, TripCause::kNone}));
  EXPECT_EQ(permit().evidence.limit, 0.0);
  RunFor(10'000 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle);
  EXPECT_FALSE(lines_.relay_closed());
}

}  // namespace
}  // namespace flexarm
