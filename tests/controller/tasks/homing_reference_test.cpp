#include "controller/tasks/homing_reference.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

constexpr HomingPlan kPlan{
    .line = Line::kLimit2High, .joint = 1, .step_rad = 0.002, .travel_rad = 0.5, .back_rad = 0.1};
constexpr LineLevels kOpen = kHealthyLevels & ~LineBit(Line::kLimit2High);

class HomingGoalTest : public testing::Test {
 protected:
  HomingGoalTest() { goal_.Start(kPlan, {0.3, -0.2}); }
  HomingReference goal_;
};

TEST_F(HomingGoalTest, MovesItsJointAndHoldsTheOther) {
  ReferenceSample sample{};
  for (int k = 0; k < 50; ++k) sample = goal_.Next(kHealthyLevels, {0.3, -0.2});
  EXPECT_DOUBLE_EQ(sample.x_m[0], 0.3);
  EXPECT_NEAR(sample.x_m[1], -0.2 + 50 * 0.002, 1e-12);
  EXPECT_FALSE(goal_.ended());
}

TEST_F(HomingGoalTest, ReversesFromTheHubAngleWhenTheSwitchOpens) {
  for (int k = 0; k < 50; ++k) goal_.Next(kHealthyLevels, {0.3, -0.12});
  ReferenceSample sample = goal_.Next(kOpen, {0.3, -0.11});  // the hub lags behind its goal
  EXPECT_NEAR(sample.x_m[1], -0.11 - 0.002, 1e-12);
  int steps = 1;
  for (; !goal_.ended() && steps < 1000; ++steps) sample = goal_.Next(kHealthyLevels, {0.3, -0.15});
  EXPECT_NEAR(sample.x_m[1], -0.11 - 0.1, kPlan.step_rad);
  EXPECT_NEAR(steps, 50, 1);
}

TEST_F(HomingGoalTest, ASwitchThatOpensAgainDuringTheMotionBackHasNoEffect) {
  goal_.Next(kOpen, {0.3, 0.0});
  const double before = goal_.Next(kHealthyLevels, {0.3, 0.0}).x_m[1];
  EXPECT_LT(goal_.Next(kOpen, {0.3, 0.0}).x_m[1], before);
}

TEST_F(HomingGoalTest, EndsTheSearchAfterItsTravel) {
  double farthest = 0.0;
  int steps = 0;
  for (; !goal_.ended() && steps < 1000; ++steps) {
    farthest = goal_.Next(kHealthyLevels, {0.3, 0.0}).x_m[1];
  }
  EXPECT_NEAR(farthest, -0.2 + kPlan.travel_rad, kPlan.step_rad);
  EXPECT_EQ(goal_.Next(kHealthyLevels, {0.3, 0.0}).x_m[1], farthest) << "and stays there";
}

TEST_F(HomingGoalTest, SearchesInTheOtherDirectionWithANegativeStep) {
  HomingPlan low = kPlan;
  low.line = Line::kLimit2Low;
  low.step_rad = -0.002;
  goal_.Start(low, {0.0, 0.0});
  EXPECT_LT(goal_.Next(kHealthyLevels, {0.0, 0.0}).x_m[1], 0.0);
  goal_.Next(kHealthyLevels & ~LineBit(Line::kLimit2Low), {0.0, -0.1});
  EXPECT_GT(goal_.Next(kHealthyLevels, {0.0, -0.1}).x_m[1], -0.1);
}

}  // namespace
}  // namespace flexarm
