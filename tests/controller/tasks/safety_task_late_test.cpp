#include <gtest/gtest.h>

#include <ostream>

#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

// The safety thread wakes late, in each state; and the shutdown.

namespace flexarm {

void PrintTo(SafetyState state, std::ostream* out) { *out << ToString(state); }

namespace {

using enum SafetyState;

class LateSafetyThread : public SafetyTaskTest, public testing::WithParamInterface<SafetyState> {
 protected:
  LateSafetyThread() : SafetyTaskTest(TestsPower(GetParam()) ? kWitnessLimits : kLimits) {
    drive_.supply = TestsPower(GetParam()) ? &lines_ : nullptr;
  }

  void EnterState(SafetyState state) {
    switch (state) {
      case kStarting:
        RunFor(5 * kMs);
        break;
      case kIdle:
      case kArmed:
      case kRunning:
        GoTo(state);
        break;
      case kStopping:
        GoTo(kRunning);
        ASSERT_EQ(Now(RequestKind::kStop), Refusal::kNone);
        break;
      case kFaultStopping:
        GoTo(kRunning);
        control_.report.faults = CauseBit(TripCause::kSoftLimit1);
        control_.report.may_damp = true;
        RunFor(40 * kMs);
        break;
      case kDisarming:
        GoTo(kArmed);
        drive_.stuck_on = true;
        Ask(RequestKind::kDisarm);
        RunFor(2 * kMs);
        break;
      case kTestingPump:
      case kTestingRelay:
      case kTestingPower:
        GoTo(kIdle);
        Ask(RequestKind::kArm);
        for (int ms = 0; ms < 500 && safety_.status().state != state; ++ms) RunFor(kMs);
        break;
      case kTripped:
        GoTo(kRunning);
        lines_.levels &= ~LineBit(Line::kEmergencyStop);
        RunFor(2 * kMs);  // its second sample
        lines_.levels = kHealthyLevels;
        break;
    }
    ASSERT_EQ(safety_.status().state, state);
  }

  void WakeLate(std::int64_t delay_ns) {
    lines_.written.clear();
    late_.delay_ns = delay_ns;
    RunFor(delay_ns / kMs * kMs + kMs);
    ASSERT_EQ(lines_.written.size(), 1u) << "it ran once, late";
  }

  static bool Off(const FakeLines::Written& written) {
    return !written.outputs.relay_closed && !written.outputs.pump_level;
  }
};

INSTANTIATE_TEST_SUITE_P(In, LateSafetyThread,
                         testing::Values(kStarting, kIdle, kArmed, kRunning, kStopping,
                                         kFaultStopping, kDisarming, kTestingPump, kTestingRelay,
                                         kTestingPower, kTripped),
                         [](const testing::TestParamInfo<SafetyState>& tested) {
                           return std::string(ToString(tested.param));
                         });

TEST_P(LateSafetyThread, WithinTheLimitItOnlyCostsTime) {
  EnterState(GetParam());
  for (const std::int64_t delay_ns : {2 * kMs, 4 * kMs}) {
    WakeLate(delay_ns);
    EXPECT_EQ(safety_.status().state, GetParam()) << "the permit is at most 5 ms old";
    RunFor(2 * kMs);
  }
  EXPECT_EQ(timing_.Read().safety_overruns, 0u);
}

TEST_F(SafetyTaskTest, AlreadyTheSecondTickMayNotBeLate) {
  RunFor(kMs);
  late_.delay_ns = 6 * kMs;
  RunFor(7 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kSafetyOverrun}));
}

// Not even for the tick that comes late: the drives find no pump and no permit.
TEST_P(LateSafetyThread, BeyondTheLimitItTripsAndThePumpStaysOffUntilReset) {
  for (const std::int64_t delay_ns : {6 * kMs, 20 * kMs, 100 * kMs, 4 * kMs + 1}) {
    SCOPED_TRACE(delay_ns);
    EnterState(GetParam());
    const TripCause before = safety_.status().cause;
    WakeLate(delay_ns);
    EXPECT_EQ(safety_.status().state, kTripped);
    EXPECT_EQ(safety_.status().cause,
              before == TripCause::kNone ? TripCause::kSafetyOverrun : before)
        << "what latched before stays";
    if (before == TripCause::kNone) {
      EXPECT_DOUBLE_EQ(permit().evidence.value, 1e-9 * static_cast<double>(delay_ns + kMs));
      EXPECT_DOUBLE_EQ(permit().evidence.limit, 0.005);
    }
    drive_.stuck_on = false;
    RunFor(1'000 * kMs);
    EXPECT_EQ(safety_.status().state, kTripped) << "in time again, and latched";
    for (const auto& written : lines_.written) ASSERT_TRUE(Off(written)) << written.now_ns;
    EXPECT_EQ(drive_.torque_nm[0], 0.0);
    ASSERT_NE(Now(RequestKind::kReset), Refusal::kNone) << "the button comes first";
    ASSERT_EQ(Reset(), Refusal::kNone);
    EXPECT_EQ(safety_.status().state, kIdle);
    EXPECT_FALSE(lines_.relay_closed());
    if (GetParam() == kStarting) break;  // it is not entered again
  }
}

TEST_F(SafetyTaskTest, AnOverrunIsInTheRecordsWhichReplay) {
  GoTo(kRunning);
  late_.delay_ns = 20 * kMs;
  RunFor(21 * kMs);
  const SafetyRecord last = Records().back();
  EXPECT_EQ(last.facts.present, CauseBit(TripCause::kSafetyOverrun));
  EXPECT_EQ(NextSafetyState(last.before, last.facts).status, last.after);
  EXPECT_EQ(last.after, (SafetyStatus{kTripped, TripCause::kSafetyOverrun}));
  EXPECT_DOUBLE_EQ(last.evidence.value, 0.021);
}

constexpr MonitorLimits kSimulatedLimits = [] {
  MonitorLimits limits = kLimits;
  limits.late_threads_trip = false;
  return limits;
}();

// No metal moves: the same delays are counted, and nothing trips.
struct LateSafetyThreadOfASimulatedArm : SafetyTaskTest {
  LateSafetyThreadOfASimulatedArm() : SafetyTaskTest(kSimulatedLimits) {}
};

TEST_F(LateSafetyThreadOfASimulatedArm, IsCountedAndDoesNotTrip) {
  GoTo(kRunning);
  for (const std::int64_t delay_ns : {2 * kMs, 6 * kMs, 20 * kMs, 100 * kMs}) {
    late_.delay_ns = delay_ns;
    RunFor(delay_ns + 50 * kMs);
  }
  control_.report.missed_in_a_row = 5;
  control_.report.missed_in_window = 20;
  RunFor(100 * kMs);
  EXPECT_EQ(safety_.status().state, kRunning) << ToString(safety_.status().cause);
  EXPECT_EQ(timing_.Read(), (TimingCounts{.safety_overruns = 3,
                                          .oldest_permit_ns = 101 * kMs,
                                          .deadlines_missed = 1,
                                          .deadlines_often_missed = 1}));
  control_.report.missed_in_a_row = 0;
  RunFor(100 * kMs);
  control_.report.missed_in_a_row = 3;
  RunFor(100 * kMs);
  EXPECT_EQ(timing_.Read().deadlines_missed, 2u) << "once each time";
  EXPECT_EQ(timing_.Read().deadlines_often_missed, 1u) << "still the same";
}

// The daemon ends.
class ShutdownOfTheArm : public SafetyTaskTest {
 protected:
  using SafetyTaskTest::SafetyTaskTest;

  // The tick at which the relay is open, after the shutdown began in this tick.
  std::int64_t OpensAfterNs(std::int64_t at_most_ns) {
    const std::int64_t begun_ns = executor_.next_ns();
    shutting_down_ = true;
    while (executor_.next_ns() < begun_ns + at_most_ns) {
      RunFor(kMs);
      if (!lines_.relay_closed()) return lines_.written.back().now_ns - begun_ns;
    }
    return INT64_MAX;
  }
  bool PumpIsOff() const { return !lines_.written.back().outputs.pump_level; }
};

TEST_F(ShutdownOfTheArm, ADampedStopThenDrivesOffThenTheRelay) {
  GoTo(kRunning);
  shutting_down_ = true;
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kStopping);
  RunFor(300 * kMs);
  EXPECT_EQ(drive_.torque_nm[0], 1.0) << "damped";
  EXPECT_TRUE(lines_.relay_closed());
  control_.report.at_rest = true;
  while (safety_.status().state != kDisarming) RunFor(kMs);
  EXPECT_EQ(drive_.report.power, DrivePower::kOn);
  EXPECT_TRUE(lines_.relay_closed()) << "until the drives have confirmed";
  while (lines_.relay_closed()) RunFor(kMs);
  EXPECT_EQ(drive_.report.power, DrivePower::kOff);
  EXPECT_EQ(safety_.status().state, kIdle);
  EXPECT_TRUE(PumpIsOff());
}

TEST_F(ShutdownOfTheArm, DrivesThatDoNotConfirmDelayTheRelayBy100Ms) {
  GoTo(kRunning);
  drive_.stuck_on = true;
  control_.report.at_rest = true;
  RunFor(20 * kMs);
  const std::int64_t opens_ns = OpensAfterNs(1'000 * kMs);
  EXPECT_GT(opens_ns, 100 * kMs);
  EXPECT_LE(opens_ns, 150 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle);
}

TEST_F(ShutdownOfTheArm, AThreadThatHangsDoesNotKeepTheRelayClosed) {
  for (Task* hangs : {static_cast<Task*>(&control_), static_cast<Task*>(&drive_)}) {
    SCOPED_TRACE(hangs->traits().name);
    shutting_down_ = false;
    control_.stopped = drive_.stopped = false;
    GoTo(kRunning);
    (hangs == &control_ ? control_.stopped : drive_.stopped) = true;
    EXPECT_LE(OpensAfterNs(1'000 * kMs), 2 * kPeriodNs + 2 * kMs);
    EXPECT_EQ(safety_.status().state, kTripped);
    EXPECT_TRUE(PumpIsOff());
    control_.stopped = drive_.stopped = false;
    shutting_down_ = false;
    RunFor(100 * kMs);
    ASSERT_EQ(Reset(), Refusal::kNone);
  }
}

TEST_F(ShutdownOfTheArm, AnArmThatDoesNotComeToRestTripsInTime) {
  GoTo(kRunning);
  EXPECT_EQ(OpensAfterNs(10'000 * kMs), kLimits.stop_timeout_ns + kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kStopTimeout);
}

// Stopping, then damping after a fault, each within its own limit: together they are too long.
constexpr MonitorLimits kLongDamping = [] {
  MonitorLimits limits = kLimits;
  limits.fault_stop_ns = 2'000 * kMs;
  return limits;
}();

struct LongShutdown : ShutdownOfTheArm {
  LongShutdown() : ShutdownOfTheArm(kLongDamping) {}
};

TEST_F(LongShutdown, TheSafetyTaskOpensTheRelayWhenTheLimitHasPassed) {
  GoTo(kRunning);
  control_.report.may_damp = true;
  const std::int64_t begun_ns = executor_.next_ns();
  shutting_down_ = true;
  RunFor(2'900 * kMs);
  control_.report.faults = CauseBit(TripCause::kHubRate1);
  RunFor(100 * kMs);
  ASSERT_EQ(safety_.status().state, kFaultStopping);
  while (lines_.relay_closed() && executor_.next_ns() < begun_ns + 10'000 * kMs) RunFor(kMs);
  const std::int64_t limit_ns = kLongDamping.stop_timeout_ns + SafetyMonitor::kShutdownMarginNs;
  EXPECT_EQ(lines_.written.back().now_ns, begun_ns + limit_ns + kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kHubRate1}));
  EXPECT_NE(Records().back().facts.present & CauseBit(TripCause::kShutdownTimeout), 0u);
  EXPECT_TRUE(PumpIsOff());
}

// Whatever ended the thread.
TEST_F(SafetyTaskTest, TheEndOfTheThreadOpensTheRelay) {
  GoTo(kRunning);
  ASSERT_TRUE(lines_.relay_closed());
  safety_.Ended();
  EXPECT_FALSE(lines_.written.back().outputs.relay_closed);
  EXPECT_FALSE(lines_.written.back().outputs.pump_level);
  EXPECT_EQ(lines_.written.back().now_ns, executor_.next_ns());
}

}  // namespace
}  // namespace flexarm
