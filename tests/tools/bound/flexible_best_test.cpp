#include "tools/bound/flexible_best.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/bound/golden_moves.h"
#include "tools/bound/fastest_plan.h"
#include "tools/bound/rigid_straight.h"

namespace flexarm {
namespace {

TEST(FlexibleBestFound, KeepsEveryLimitAndEndsAtRest) {
  const RigidJointArm arm(BoundRig().arm);
  const BoundLimits limits = GoldenLimits();
  const RestMove move{.from_rad = {0.0, 0.0}, .to_rad = {0.1, 0.9}, .payload_kg = 0.0};
  const FoundMotion found = FlexibleBestFound(arm, limits, move, 0.02);
  ASSERT_FALSE(found.trace.empty());
  constexpr double kMost = 1.0 + FastestPlan::kMostViolation;
  for (const TracePoint& point : found.trace) {
    for (int i = 0; i < 2; ++i) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_LE(std::fabs(point.torque_nm[i]), limits.torque_nm[at] * (1.0 + 1e-12));
      EXPECT_LE(std::fabs(point.rate_rad_s[i]), limits.hub_rate_rad_s[at] * kMost);
      EXPECT_LE(std::fabs(point.angle_rad[i]), limits.hub_angle_rad[at] * kMost);
      EXPECT_LE(std::fabs(point.strain[i]), limits.strain[at] * kMost);
    }
  }
  // kMostViolation of the goal's scales, 0.1 rad and 1 rad/s. Strain of 0.05 m of each mode: 5.7e-3
  // for the second of link 2.
  EXPECT_LT((found.trace.back().angle_rad - move.to_rad).cwiseAbs().maxCoeff(), 2e-4);
  EXPECT_LT(found.trace.back().rate_rad_s.cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT(found.trace.back().strain.cwiseAbs().maxCoeff(), 0.1 * limits.strain[0]);
  // A light arm loses little by its bending: the study's move (0,0) to (5,50) has 0.40 / 0.301.
  const double straight_s = RigidStraight_s(arm, limits, move);
  EXPECT_LT(found.trace.back().time_s, 1.5 * straight_s);
  EXPECT_GT(found.trace.back().time_s, 0.95 * straight_s);
}

TEST(FlexibleBestFound, SaysThatNothingWasFound) {
  const RigidJointArm arm(BoundRig().arm);
  BoundLimits limits = GoldenLimits();
  limits.hub_angle_rad = {0.05, 0.05};  // the goal is beyond: no motion ends there
  const RestMove move{.from_rad = {0.0, 0.0}, .to_rad = {0.0, 0.4}, .payload_kg = 0.0};
  const FoundMotion found = FlexibleBestFound(arm, limits, move, 0.02);
  EXPECT_TRUE(found.trace.empty());
  EXPECT_GT(found.violation, FastestPlan::kMostViolation);
}

}  // namespace
}  // namespace flexarm
