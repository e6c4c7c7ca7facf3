#include "tools/bound/rigid_free.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/bound/golden_moves.h"
#include "tools/bound/rigid_straight.h"

namespace flexarm {
namespace {

TEST(RigidFree, IsNoSlowerThanTheStraightLineAndKeepsEveryLimit) {
  const RigidJointArm arm(BoundRig().arm);
  const BoundLimits limits = GoldenLimits();
  const RestMove move{.from_rad = {-0.35, 0.7}, .to_rad = {0.6, -0.5}, .payload_kg = 0.1};
  const FoundMotion found = RigidFreeMotion(arm, limits, move);
  const double straight_s = RigidStraight_s(arm, limits, move);
  EXPECT_LT(found.trace.back().time_s, straight_s);
  EXPECT_GT(found.trace.back().time_s, 0.9 * straight_s);  // the study: 2.8 % on average
  for (const TracePoint& point : found.trace) {
    for (int i = 0; i < 2; ++i) {
      const auto at = static_cast<std::size_t>(i);
      // FastestPlan::kMostViolation; torques keep their limits but for round-off.
      EXPECT_LE(std::fabs(point.torque_nm[i]), limits.rigid_torque_nm()[at] * (1.0 + 1e-12));
      EXPECT_LE(std::fabs(point.rate_rad_s[i]), limits.hub_rate_rad_s[at] * 1.002);
      EXPECT_LE(std::fabs(point.angle_rad[i]), limits.hub_angle_rad[at] * 1.002);
    }
  }
  // 0.2 % of 0.1 rad and of 1 rad/s
  EXPECT_LT((found.trace.back().angle_rad - move.to_rad).cwiseAbs().maxCoeff(), 2e-4);
  EXPECT_LT(found.trace.back().rate_rad_s.cwiseAbs().maxCoeff(), 2e-3);
}

}  // namespace
}  // namespace flexarm
