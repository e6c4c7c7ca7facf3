#include "controller/safety/power_path.h"

#include <gtest/gtest.h>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using enum SafetyState;

constexpr PowerPathLimits kTimes{
    .rise_ns = 300 * kMs, .fall_ns = 1000 * kMs, .report_ns = 60 * kMs};
constexpr DriveVoltage kOn{.on = 0b11, .off = 0};
constexpr DriveVoltage kOff{.on = 0, .off = 0b11};
constexpr DriveVoltage kHalf{.on = 0b01, .off = 0b10};
constexpr DriveVoltage kPart{.on = 0, .off = 0b01};  // of the other drive nothing is known

constexpr std::int64_t kBeginNs = 7000 * kMs;

// One state, from kBeginNs on, after a state in which the voltage agreed.
struct Path {
  explicit Path(SafetyState now, SafetyState before = kIdle, DriveVoltage was = kOff) : state(now) {
    monitor.Judge({.due_ns = kBeginNs - kMs,
                   .state = before,
                   .state_since_ns = kBeginNs - 5000 * kMs,
                   .voltage = was,
                   .reported_ns = kBeginNs - 20 * kMs});
  }
  bool FailsAt(std::int64_t ms, DriveVoltage voltage, std::int64_t reported_ms = INT64_MIN) {
    const std::int64_t reported_ns = kBeginNs + (reported_ms == INT64_MIN ? ms : reported_ms) * kMs;
    return monitor.Judge({.due_ns = kBeginNs + ms * kMs,
                          .state = state,
                          .state_since_ns = kBeginNs,
                          .voltage = voltage,
                          .reported_ns = reported_ns});
  }
  LineTrouble trouble() const { return static_cast<LineTrouble>(monitor.evidence().channel); }

  SafetyState state;
  PowerPathMonitor monitor{kTimes};
};

TEST(PowerPath, WithoutAWitnessNothingIsJudged) {
  EXPECT_TRUE(PowerPathLimits{.rise_ns = 1}.witness());
  PowerPathMonitor monitor{PowerPathLimits{}};
  for (int i = 0; i < kSafetyStates; ++i) {
    for (const DriveVoltage voltage : {kOn, kOff, kHalf, DriveVoltage{}}) {
      EXPECT_FALSE(monitor.Judge({.due_ns = i * 10'000 * kMs,
                                  .state = static_cast<SafetyState>(i),
                                  .state_since_ns = 0,
                                  .voltage = voltage,
                                  .reported_ns = 0}));
      EXPECT_TRUE(monitor.follows());
    }
  }
}

TEST(PowerPath, AContradictionFromTheFirstTickOnCountsFromThere) {
  PowerPathMonitor monitor{kTimes};
  const auto fails_at = [&](std::int64_t ms) {
    return monitor.Judge({.due_ns = kBeginNs + ms * kMs,
                          .state = kStarting,
                          .state_since_ns = INT64_MIN,
                          .voltage = kOn,
                          .reported_ns = 0});
  };
  EXPECT_FALSE(fails_at(0));
  EXPECT_FALSE(fails_at(1060));
  EXPECT_TRUE(fails_at(1061));
}

TEST(PowerPath, WithBothOpenNoDriveMayHaveVoltageAfterTheFallTime) {
  for (const SafetyState state : {kIdle, kTripped, kStarting}) {
    for (const DriveVoltage voltage : {kOn, kHalf}) {
      Path path(state, kArmed, kOn);
      for (int ms = 0; ms <= 1059; ++ms) {
        ASSERT_FALSE(path.FailsAt(ms, voltage)) << ms;
        ASSERT_FALSE(path.monitor.follows());
      }
      EXPECT_TRUE(path.FailsAt(1060, voltage));
      EXPECT_EQ(path.trouble(), LineTrouble::kVoltageStaysOn);
      EXPECT_DOUBLE_EQ(path.monitor.evidence().value, 1.061);
      EXPECT_DOUBLE_EQ(path.monitor.evidence().limit, 1.06);
      EXPECT_EQ(path.monitor.evidence().detail, 0u);
      EXPECT_FALSE(path.FailsAt(1061, kOff));
      EXPECT_EQ(path.monitor.evidence().value, 0.0) << "of the last tick";
      EXPECT_TRUE(path.monitor.follows());
    }
  }
}

TEST(PowerPath, WithBothClosedEveryDriveMustHaveVoltageAfterTheRiseTime) {
  for (const SafetyState state :
       {kTestingPower, kArmed, kRunning, kStopping, kFaultStopping, kDisarming}) {
    for (const DriveVoltage voltage : {kOff, kHalf}) {
      Path path(state, kTestingRelay);
      for (int ms = 0; ms <= 359; ++ms) ASSERT_FALSE(path.FailsAt(ms, voltage)) << ms;
      EXPECT_FALSE(path.monitor.follows());
      EXPECT_TRUE(path.FailsAt(360, voltage));
      EXPECT_EQ(path.trouble(), LineTrouble::kVoltageMissing);
      EXPECT_DOUBLE_EQ(path.monitor.evidence().value, 0.361);
      EXPECT_DOUBLE_EQ(path.monitor.evidence().limit, 0.36);
    }
    Path path(state, kTestingRelay);
    EXPECT_FALSE(path.FailsAt(300, kOn));
    EXPECT_TRUE(path.monitor.follows());
  }
}

TEST(PowerPath, OneAloneMustNotGiveVoltageToAnyDrive) {
  for (const DriveVoltage voltage : {kOn, kHalf}) {
    Path pump(kTestingPump);
    EXPECT_TRUE(pump.FailsAt(5, voltage));
    EXPECT_EQ(pump.trouble(), LineTrouble::kRelayStuckClosed);
    Path relay(kTestingRelay);
    EXPECT_TRUE(relay.FailsAt(5, voltage));
    EXPECT_EQ(relay.trouble(), LineTrouble::kPumpStuckOn);
    EXPECT_DOUBLE_EQ(relay.monitor.evidence().value, 0.005);
    EXPECT_DOUBLE_EQ(relay.monitor.evidence().limit, 0.0);
  }
}

// A DC link that a stuck channel feeds is not up before the rise time: an earlier report proves
// nothing, however late it is read.
TEST(PowerPath, ATestPassesByAReportOfAWholeRiseTimeAfterItsBegin) {
  for (const SafetyState test : {kTestingPump, kTestingRelay}) {
    Path path(test);
    for (int ms = 0; ms <= 360; ++ms) {
      ASSERT_FALSE(path.FailsAt(ms, kOff, std::min(ms, 299)));
      ASSERT_FALSE(path.monitor.follows()) << ms;
    }
    ASSERT_FALSE(path.FailsAt(360, kOff, 300));
    EXPECT_TRUE(path.monitor.follows());
  }
}

TEST(PowerPath, WhatIsNotKnownEndsNoTestAndATestThatDoesNotEndFails) {
  for (const SafetyState test : {kTestingPump, kTestingRelay, kTestingPower}) {
    for (const DriveVoltage voltage : {DriveVoltage{}, kPart}) {
      if (test == kTestingPower && voltage.off != 0) continue;  // is known to be wrong
      Path path(test);
      for (int ms = 0; ms <= 360; ++ms) {
        ASSERT_FALSE(path.FailsAt(ms, voltage)) << ms;
        ASSERT_FALSE(path.monitor.follows());
      }
      EXPECT_TRUE(path.FailsAt(361, voltage));
      EXPECT_EQ(path.trouble(), LineTrouble::kVoltageUnknown);
      EXPECT_DOUBLE_EQ(path.monitor.evidence().value, 0.361);
      EXPECT_DOUBLE_EQ(path.monitor.evidence().limit, 0.36);
    }
  }
}

TEST(PowerPath, WhatIsNotKnownIsNoOpenPathAndNoContradiction) {
  for (const SafetyState state : {kIdle, kArmed}) {
    Path path(state);
    for (int ms = 0; ms <= 5000; ms += 100) {
      EXPECT_FALSE(path.FailsAt(ms, DriveVoltage{}));
      EXPECT_FALSE(path.monitor.follows());
    }
  }
}

}  // namespace
}  // namespace flexarm
