#include "controller/operator/shutdown.h"

#include <gtest/gtest.h>

#include "controller/safety/safety_monitor.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using enum SafetyState;

constexpr std::int64_t kLimitNs = 4'000 * kMs;

struct ShutdownTest : testing::Test {
  ShutdownTest() { shutdown.Begin(kBeginNs, INT64_MAX); }

  // One period `after_ms` after the beginning.
  void At(std::int64_t after_ms, SafetyState state) {
    shutdown.Update(kBeginNs + after_ms * kMs, state);
  }

  static constexpr std::int64_t kBeginNs = 5'000 * kMs;
  Shutdown shutdown{kLimitNs};
};

TEST_F(ShutdownTest, IsNotOverWhileTheArmHasPower) {
  for (const SafetyState powered :
       {kArmed, kRunning, kStopping, kFaultStopping, kDisarming, kTestingRelay, kTestingPower}) {
    At(0, powered);
    At(3'900, powered);
    EXPECT_FALSE(shutdown.over()) << ToString(powered);
  }
}

TEST_F(ShutdownTest, IsOverOnceTheLastRecordsAreTaken) {
  for (const SafetyState end : {kIdle, kTripped, kStarting}) {
    Shutdown one(kLimitNs);
    one.Begin(kBeginNs, INT64_MAX);
    one.Update(kBeginNs, kStopping);
    one.Update(kBeginNs + 500 * kMs, end);
    one.Update(kBeginNs + 799 * kMs, end);
    EXPECT_FALSE(one.over()) << ToString(end);
    one.Update(kBeginNs + 800 * kMs, end);
    EXPECT_TRUE(one.over()) << ToString(end);
  }
}

TEST_F(ShutdownTest, EndsAlthoughTheArmDoesNotComeToRest) {
  At(0, kRunning);
  At(4'000, kStopping);
  At(4'400, kStopping);
  EXPECT_FALSE(shutdown.over()) << "the settling time begins once the limit has passed";
  At(4'700, kStopping);
  EXPECT_TRUE(shutdown.over());
}

// A stop that does not end trips after stop_timeout_s, which opens the relay: that comes first.
TEST(Shutdown, ItsLimitIsAboveTheLongestStop) {
  for (const char* stop_s : {"3.0", "8.0"}) {
    const RigConfig rig = ShippedRig({std::string("safety.stop_timeout_s=") + stop_s});
    EXPECT_GT(Shutdown::LimitNs(rig.safety), std::llround(1e9 * rig.safety.stop_timeout_s));
  }
}

// The relay is open before this task gives up waiting: it looks once in 20 ms, and later.
TEST(Shutdown, ItsLimitIsAboveThatOfTheSafetyTask) {
  const SafetyConfig safety = ShippedRig().safety;
  const std::int64_t safety_ns =
      std::llround(1e9 * safety.stop_timeout_s) + SafetyMonitor::kShutdownMarginNs;
  EXPECT_GT(Shutdown::LimitNs(safety), safety_ns + 100 * kMs);
}

TEST(Shutdown, EndsWhenTheDaemonWouldHaveEndedAnyway) {
  Shutdown shutdown(kLimitNs);
  EXPECT_FALSE(shutdown.begun());
  shutdown.Begin(0, 4'000 * kMs);  // of a run that tripped 1 s ago
  EXPECT_TRUE(shutdown.begun());
  shutdown.Update(0, kTripped);
  shutdown.Update(3'980 * kMs, kTripped);
  EXPECT_FALSE(shutdown.over());
  shutdown.Update(4'000 * kMs, kTripped);
  EXPECT_TRUE(shutdown.over());
}

}  // namespace
}  // namespace flexarm
