#include "controller/operator/shutdown.h"

#include <gtest/gtest.h>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using enum SafetyState;

struct ShutdownTest : testing::Test {
  ShutdownTest() { shutdown.Begin(kBeginNs, INT64_MAX); }

  // One period `after_ms` after the beginning.
  RequestKind At(std::int64_t after_ms, SafetyState state) {
    return shutdown.Update(kBeginNs + after_ms * kMs, state);
  }

  static constexpr std::int64_t kBeginNs = 5'000 * kMs;
  Shutdown shutdown;
};

TEST_F(ShutdownTest, StopsARunThenDisarmsAndAsksOnceAState) {
  EXPECT_EQ(At(0, kRunning), RequestKind::kStop);
  EXPECT_EQ(At(20, kRunning), RequestKind::kNone) << "asked already";
  EXPECT_EQ(At(40, kStopping), RequestKind::kNone);
  EXPECT_EQ(At(900, kArmed), RequestKind::kDisarm);
  EXPECT_EQ(At(920, kArmed), RequestKind::kNone) << "asked already";
  EXPECT_EQ(At(940, kIdle), RequestKind::kNone);
  EXPECT_FALSE(shutdown.over());
}

TEST_F(ShutdownTest, IsOverOnceTheLastRecordsAreTaken) {
  for (const SafetyState end : {kIdle, kTripped, kStarting}) {
    Shutdown one;
    one.Begin(kBeginNs, INT64_MAX);
    one.Update(kBeginNs, kStopping);
    one.Update(kBeginNs + 500 * kMs, end);
    EXPECT_EQ(one.Update(kBeginNs + 799 * kMs, end), RequestKind::kNone);
    EXPECT_FALSE(one.over()) << ToString(end);
    one.Update(kBeginNs + 800 * kMs, end);
    EXPECT_TRUE(one.over()) << ToString(end);
  }
}

TEST_F(ShutdownTest, EndsAlthoughTheArmDoesNotComeToRest) {
  At(0, kRunning);
  At(6'000, kStopping);
  At(6'400, kStopping);
  EXPECT_FALSE(shutdown.over()) << "the settling time begins once the limit has passed";
  EXPECT_EQ(At(6'700, kStopping), RequestKind::kNone);
  EXPECT_TRUE(shutdown.over());
}

TEST_F(ShutdownTest, IsNotOverWhileTheArmIsArmedAgain) {
  At(0, kIdle);
  EXPECT_EQ(At(200, kArmed), RequestKind::kDisarm) << "a client has armed it";
  At(400, kArmed);
  EXPECT_FALSE(shutdown.over());
  At(420, kIdle);
  EXPECT_TRUE(shutdown.over()) << "the records of 300 ms ago are taken";
}

TEST(Shutdown, EndsWhenTheDaemonWouldHaveEndedAnyway) {
  Shutdown shutdown;
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
