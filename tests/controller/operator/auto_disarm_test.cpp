#include "controller/operator/auto_disarm.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(AutoDisarm, AnUnusedArmIsDisarmed) {
  AutoDisarm disarm(10.0);
  EXPECT_FALSE(disarm.Follow(0, SafetyState::kArmed));
  EXPECT_FALSE(disarm.Follow(10 * kSecond - 1, SafetyState::kArmed));
  EXPECT_TRUE(disarm.Follow(10 * kSecond, SafetyState::kArmed));
  EXPECT_FALSE(disarm.Follow(11 * kSecond - 1, SafetyState::kArmed)) << "asked a moment ago";
  EXPECT_TRUE(disarm.Follow(11 * kSecond, SafetyState::kArmed)) << "that was refused";
}

TEST(AutoDisarm, ARunBeginsTheTimeAgain) {
  AutoDisarm disarm(10.0);
  disarm.Follow(0, SafetyState::kArmed);
  disarm.Follow(9 * kSecond, SafetyState::kRunning);
  EXPECT_FALSE(disarm.Follow(60 * kSecond, SafetyState::kRunning)) << "a long run";
  EXPECT_FALSE(disarm.Follow(61 * kSecond, SafetyState::kArmed));
  EXPECT_FALSE(disarm.Follow(70 * kSecond, SafetyState::kArmed));
  EXPECT_TRUE(disarm.Follow(71 * kSecond, SafetyState::kArmed));
}

TEST(AutoDisarm, ZeroIsNever) {
  AutoDisarm disarm(0.0);
  disarm.Follow(0, SafetyState::kArmed);
  EXPECT_FALSE(disarm.Follow(INT64_MAX, SafetyState::kArmed));
}

}  // namespace
}  // namespace flexarm
