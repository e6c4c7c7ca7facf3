#include <gtest/gtest.h>

#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

// The lines of the safety chain themselves: calls that fail or take too long, and interference.

namespace flexarm {
namespace {

using enum SafetyState;

class SafetyTaskLines : public SafetyTaskTest {
 protected:
  void ExpectTripped(LineTrouble trouble, double took_s) {
    EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kSafetyLines}))
        << ToString(safety_.status().cause);
    EXPECT_EQ(permit().evidence.channel, static_cast<std::uint32_t>(trouble));
    EXPECT_DOUBLE_EQ(permit().evidence.value, took_s);
    EXPECT_DOUBLE_EQ(permit().evidence.limit, 0.0002);
    EXPECT_FALSE(lines_.relay_closed());
  }
};

TEST_F(SafetyTaskLines, AFailedReadTripsInItsTickUnderItsOwnName) {
  GoTo(kRunning);
  lines_.read.ok = false;
  lines_.levels = 0;  // as a failed read returns them
  RunFor(kMs);
  ExpectTripped(LineTrouble::kReadFailed, 0.0);
}

TEST_F(SafetyTaskLines, AFailedWriteTripsInTheNextTick) {
  GoTo(kRunning);
  lines_.write.ok = false;
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kRunning) << "the write is the last act of a tick";
  RunFor(kMs);
  ExpectTripped(LineTrouble::kWriteFailed, 0.0);
  RunFor(kMs);
  EXPECT_EQ(drive_.torque_nm[0], 0.0);
}

TEST_F(SafetyTaskLines, AReadOf50MsTripsInItsTick) {
  GoTo(kRunning);
  lines_.read.took_ns = 50 * kMs;
  RunFor(kMs);
  ExpectTripped(LineTrouble::kReadSlow, 0.05);
}

TEST_F(SafetyTaskLines, AWriteOf50MsTripsInTheNextTick) {
  GoTo(kRunning);
  lines_.write.took_ns = 50 * kMs;
  RunFor(kMs);
  lines_.write.took_ns = 0;
  RunFor(kMs);
  ExpectTripped(LineTrouble::kWriteSlow, 0.05);
}

TEST_F(SafetyTaskLines, ThreeSlowTicksAreAnInterruptAndTheFourthTrips) {
  GoTo(kRunning);
  lines_.read.took_ns = 300'000;
  RunFor(3 * kMs);
  EXPECT_EQ(safety_.status().state, kRunning);
  RunFor(kMs);
  ExpectTripped(LineTrouble::kReadSlow, 0.0003);
}

// Idle, Armed or Running: a slow chip is never armed.
TEST_F(SafetyTaskLines, LinesThatAreSlowOrFailCanNeitherBeArmedNorReset) {
  GoTo(kIdle);
  lines_.read.took_ns = 300'000;
  RunFor(4 * kMs);
  ExpectTripped(LineTrouble::kReadSlow, 0.0003);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kWrongState);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kCauseRemains);
  lines_.read = {};
  lines_.write.ok = false;
  RunFor(100 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kCauseRemains);
  lines_.write = {};
  lines_.levels |= LineBit(Line::kResetButton);
  RunFor(100 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNone);
}

// The contact follows 50 ms after the command, as that of a contactor.
TEST_F(SafetyTaskLines, AContactorThatTakesFiftyMillisecondsIsFine) {
  lines_.relay = RelayContact::kOpen;
  GoTo(kIdle);
  ASSERT_EQ(Now(RequestKind::kArm), Refusal::kNone);
  RunFor(50 * kMs);
  lines_.relay = RelayContact::kClosed;
  RunFor(1000 * kMs);
  EXPECT_EQ(safety_.status().state, kArmed);
  Ask(RequestKind::kDisarm);
  RunFor(50 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kRelayClosed) << "it is not known to be open yet";
  lines_.relay = RelayContact::kOpen;
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kNone);
}

TEST_F(SafetyTaskLines, ARelayThatDoesNotPullInTripsAfterTenthOfASecond) {
  lines_.relay = RelayContact::kOpen;
  GoTo(kIdle);
  ASSERT_EQ(Now(RequestKind::kArm), Refusal::kNone);
  const std::int64_t armed_ns = executor_.next_ns() - kMs;
  EXPECT_EQ(RunUntilTripped(1000 * kMs), armed_ns + 101 * kMs);
  EXPECT_EQ(permit().cause, TripCause::kSafetyLines);
  EXPECT_EQ(permit().evidence.channel, static_cast<std::uint32_t>(LineTrouble::kRelayStuckOpen));
  EXPECT_DOUBLE_EQ(permit().evidence.value, 0.101);
  EXPECT_DOUBLE_EQ(permit().evidence.limit, 0.1);
}

TEST_F(SafetyTaskLines, AWeldedRelayIsNotArmedAndTripsAndCannotBeReset) {
  lines_.relay = RelayContact::kOpen;
  GoTo(kArmed);
  lines_.relay = RelayContact::kClosed;
  RunFor(200 * kMs);
  Ask(RequestKind::kDisarm);
  RunFor(20 * kMs);
  ASSERT_EQ(safety_.status().state, kIdle);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kRelayClosed);
  RunUntilTripped(100 * kMs);
  EXPECT_EQ(permit().cause, TripCause::kSafetyLines);
  EXPECT_EQ(permit().evidence.channel, static_cast<std::uint32_t>(LineTrouble::kRelayStuckClosed));
  lines_.levels |= LineBit(Line::kResetButton);
  RunFor(60 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kCauseRemains);
}

TEST_F(SafetyTaskLines, ARelayThatIsWeldedAtTheStartIsNeverArmed) {
  lines_.relay = RelayContact::kClosed;
  RunFor(50 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kRelayClosed);
  RunFor(100 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kSafetyLines}));
}

TEST_F(SafetyTaskLines, InterferenceOfOneSampleOnEveryLineChangesNothing) {
  GoTo(kRunning);
  for (int i = 0; i < 100; ++i) {
    lines_.levels = ~kHealthyLevels;
    RunFor(kMs);
    lines_.levels = kHealthyLevels;
    RunFor(2 * kMs);
  }
  EXPECT_EQ(safety_.status().state, kRunning) << ToString(safety_.status().cause);
}

TEST_F(SafetyTaskLines, ASwitchThatIsOpenFromTheStartTripsAtItsThirdSampleAndNothingArmsBefore) {
  lines_.levels &= ~LineBit(Line::kLimit1Low);
  RunFor(2 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kStarting, TripCause::kNone}));
  EXPECT_EQ(permit().levels & LineBit(Line::kLimit1Low), 0U);
  RunFor(kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kLimitSwitch1Low}));
}

// The button was down 10 ms before the trip, and is still down: no answer to the trip.
TEST_F(SafetyTaskLines, APressThatBeganBeforeTheTripDoesNotCount) {
  GoTo(kRunning);
  lines_.levels |= LineBit(Line::kResetButton);
  RunFor(10 * kMs);
  lines_.levels &= ~LineBit(Line::kEmergencyStop);
  RunFor(2 * kMs);
  ASSERT_EQ(safety_.status().state, kTripped);
  lines_.levels |= LineBit(Line::kEmergencyStop);
  control_.report.at_rest = true;
  RunFor(1000 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNoReset);
  lines_.levels = kHealthyLevels;
  RunFor(kMs);
  lines_.levels |= LineBit(Line::kResetButton);
  RunFor(50 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNone);
}

}  // namespace
}  // namespace flexarm
