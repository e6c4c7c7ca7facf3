// The drives on two buses: the worst of both counts, and a fault has the number of its bus.

#include <gtest/gtest.h>

#include <cstdint>

#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

namespace flexarm {
namespace {

using enum SafetyState;

constexpr BusFault kFaultOfFirst{.kind = 1, .node = 2, .code = 3},
    kFaultOfSecond{.kind = 4, .node = 5, .code = 6};

struct SecondChannel {
  DriveReportChannel second_reports{DriveReportHistory(kNoDriveReport)};
};

class TwoBuses : protected SecondChannel, public SafetyTaskTest {
 protected:
  TwoBuses() : SafetyTaskTest(kLimits, {&second_reports}) {
    executor_.Add(second_);
    drive_.report.fault = kFaultOfFirst;
    second_.report.fault = kFaultOfSecond;
  }

  // Trips within 10 ms, by `cause`.
  Evidence Trip(TripCause cause) {
    RunUntilTripped(10 * kMs);
    EXPECT_EQ(safety_.status().cause, cause);
    return permit().evidence;
  }
  static void ExpectOf(const Evidence& evidence, std::uint32_t bus) {
    EXPECT_EQ(evidence.channel, bus);
    EXPECT_EQ(evidence.detail, ToBits(bus == 1 ? kFaultOfFirst : kFaultOfSecond));
  }

  FakeDrive second_{&drive_permits_, &second_reports};
};

TEST_F(TwoBuses, ALostBusIsNamed) {
  GoTo(kRunning);
  second_.report.bus_ok = false;
  ExpectOf(Trip(TripCause::kBusLost), 2);
}

TEST_F(TwoBuses, OfTwoLostBusesTheFirstIsNamed) {
  GoTo(kRunning);
  drive_.report.bus_ok = second_.report.bus_ok = false;
  ExpectOf(Trip(TripCause::kBusLost), 1);
}

TEST_F(TwoBuses, TheBusOfADriveInFaultIsNamed) {
  GoTo(kRunning);
  second_.report.drive_ok = false;
  ExpectOf(Trip(TripCause::kDriveFault), 2);
}

TEST_F(TwoBuses, OfTwoDrivesInFaultTheFirstIsNamed) {
  GoTo(kRunning);
  drive_.report.drive_ok = second_.report.drive_ok = false;
  ExpectOf(Trip(TripCause::kDriveFault), 1);
}

TEST_F(TwoBuses, AFaultOfTheFirstIsNotHiddenByTheSecond) {
  GoTo(kRunning);
  drive_.report.bus_ok = false;
  ExpectOf(Trip(TripCause::kBusLost), 1);
}

TEST_F(TwoBuses, TheOneWithTheMostFailedExchangesIsNamed) {
  GoTo(kRunning);
  drive_.report.failed_in_window = 3;
  second_.report.failed_in_window = kLimits.failed_in_window + 1;
  const Evidence evidence = Trip(TripCause::kBusUnreliable);
  ExpectOf(evidence, 2);
  EXPECT_EQ(evidence.value, kLimits.failed_in_window + 1);
}

TEST_F(TwoBuses, OfEqualNumbersOfFailedExchangesTheFirstIsNamed) {
  GoTo(kRunning);
  drive_.report.failed_in_window = second_.report.failed_in_window = kLimits.failed_in_window;
  ExpectOf(Trip(TripCause::kBusUnreliable), 1);
}

TEST_F(TwoBuses, TheOneWithTheMostSlowExchangesIsNamed) {
  GoTo(kRunning);
  drive_.report.slow_in_window = 3;
  second_.report.slow_in_window = kLimits.slow_in_window + 1;
  const Evidence evidence = Trip(TripCause::kBusTooSlow);
  ExpectOf(evidence, 2);
  EXPECT_EQ(evidence.value, kLimits.slow_in_window + 1);
}

TEST_F(TwoBuses, OfEqualNumbersOfSlowExchangesTheFirstIsNamed) {
  GoTo(kRunning);
  drive_.report.slow_in_window = second_.report.slow_in_window = kLimits.slow_in_window;
  ExpectOf(Trip(TripCause::kBusTooSlow), 1);
}

TEST_F(TwoBuses, TheOneThatHangsIsNamed) {
  for (const std::uint32_t bus : {1U, 2U}) {
    GoTo(kRunning);
    FakeDrive& hangs = bus == 1 ? drive_ : second_;
    hangs.stopped = true;
    RunUntilTripped(100 * kMs);
    EXPECT_EQ(safety_.status().cause, TripCause::kStaleFrame);
    EXPECT_EQ(permit().evidence.channel, bus);
    hangs.stopped = false;
    ASSERT_EQ(Reset(), Refusal::kNone);
  }
}

TEST_F(TwoBuses, OfTwoThatHangTheFirstIsNamed) {
  GoTo(kRunning);
  drive_.stopped = second_.stopped = true;
  RunUntilTripped(100 * kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kStaleFrame);
  EXPECT_EQ(permit().evidence.channel, 1U);
}

TEST_F(TwoBuses, ASwitchOnEitherCounts) {
  for (FakeDrive* drive : {&drive_, &second_}) {
    GoTo(kRunning);
    drive->report.levels = kHealthyLevels & ~LineBit(Line::kLimit2Low);
    Trip(TripCause::kLimitSwitch2Low);
    drive->report.levels = kHealthyLevels;
    ASSERT_EQ(Reset(), Refusal::kNone);
  }
}

TEST_F(TwoBuses, ARunWaitsForTheDrivesOfBoth) {
  for (FakeDrive* drive : {&drive_, &second_}) {
    drive->stuck_off = true;
    GoTo(kArmed);
    const std::uint32_t run = Ask(RequestKind::kRun);
    RunFor(SafetyTask::kEnableNs);
    EXPECT_EQ(safety_.status().state, kArmed);
    RequestAnswer answer{};
    while (answers_.Pop(&answer)) EXPECT_EQ(answer.refusal == Refusal::kNone, answer.number != run);
    drive->stuck_off = false;
    Ask(RequestKind::kDisarm);
  }
}

}  // namespace
}  // namespace flexarm
