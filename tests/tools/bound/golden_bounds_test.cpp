#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/campaign.h"
#include "tests/tools/bound/golden_moves.h"
#include "tools/bound/flexible_best.h"
#include "tools/bound/rigid_free.h"

namespace flexarm {
namespace {

// The other program's limits are kept to 3 % only, which can save 1.5 % of the time; this one's
// exactly. Both are the best found.
TEST(RigidFree, IsAtMostOnePercentSlowerThanAnotherProgramOnEveryMove) {
  const RigidJointArm arm(BoundRig().arm);
  const nlohmann::json moves = GoldenMoves();
  for (const auto& golden : moves) {
    const FoundMotion found = RigidFreeMotion(arm, GoldenLimits(), MoveOf(golden));
    const double other_s = golden["rigid_free_s"], share = found.trace.back().time_s / other_s;
    EXPECT_LT(share, 1.01) << golden;
    EXPECT_GT(share, 0.98) << golden;
  }
}

// Both are the best found. Measured: from 30 % faster with heavy loads to 12 % slower, -20,40 to
// 35,-30 with 0.5 kg; 0.8 % faster on average. 3 % more on each, because rounding of another
// compiler may lead a search to another local optimum.
TEST(FlexibleBestFound, CampaignIsOnAverageAsFastAsAnotherProgram) {
  const RigidJointArm arm(BoundRig().arm);
  const nlohmann::json moves = GoldenMoves();
  // A sample has every payload: the stride is coprime to the number of moves.
  constexpr std::size_t kStride = 7;
  const auto cases = static_cast<std::size_t>(std::max(1L, CampaignCases(5, 30)));
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(cases, moves.size()); ++i) {
    const nlohmann::json& golden = moves[i * kStride % moves.size()];
    const FoundMotion found = FlexibleBestFound(arm, GoldenLimits(), MoveOf(golden), 0.02);
    ASSERT_FALSE(found.trace.empty()) << golden;
    const double other_s = golden["flexible_s"], share = found.trace.back().time_s / other_s;
    EXPECT_LT(share, 1.15) << golden;
    EXPECT_GT(found.trace.back().time_s, 0.98 * golden["rigid_free_s"].get<double>()) << golden;
    sum += share;
  }
  if (cases == moves.size()) {
    EXPECT_LT(sum / 30.0, 1.022);
  }
}

}  // namespace
}  // namespace flexarm
