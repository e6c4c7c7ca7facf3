#include "tools/sweep/fast_moves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "model/units.h"
#include "tools/bound/rigid_straight.h"
#include "tools/sweep/sweep_summary.h"

namespace flexarm {
namespace {

const RigConfig& Rig() {
  static const RigConfig rig = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml");
  return rig;
}

// Bounds of the moves with a payload, by `flexarm bound`'s function.
std::vector<double> BoundsOf(const Experiment& experiment, double payload_kg) {
  const RigidJointArm arm(Rig().arm);
  const BoundLimits limits = BoundLimitsOf(Rig(), PlanTorqueShare(Rig()));
  Eigen::Vector2d from_rad = Eigen::Vector2d::Zero();
  std::vector<double> bounds_s;
  for (const Move& move : experiment.move) {
    const Eigen::Vector2d to_rad(RadFromDeg(move.to_deg[0]), RadFromDeg(move.to_deg[1]));
    bounds_s.push_back(RigidStraight_s(arm, limits, {from_rad, to_rad, payload_kg}));
    from_rad = to_rad;
  }
  return bounds_s;
}

TEST(RandomFastMoves, HaveTimeForThreeTimesTheBoundAndTheRest) {
  const MoveRecipe recipe = RecipeFor(Rig());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomMoves drawn = MakeFastMoves(Rig(), seed, recipe);
    ASSERT_EQ(drawn.experiment.move.size(), 4U);
    EXPECT_GE(drawn.payload_kg, 0.0);
    EXPECT_LE(drawn.payload_kg, 1.0);
    const std::vector<double> bounds_s = BoundsOf(drawn.experiment, drawn.payload_kg);
    for (std::size_t i = 0; i < 4; ++i) {
      const Move& move = drawn.experiment.move[i];
      EXPECT_TRUE(move.shortest);
      EXPECT_EQ(move.same_load, i > 0) << "nothing is known at the first";
      const double next_s =
          i < 3 ? drawn.experiment.move[i + 1].start_s : drawn.experiment.duration_s;
      // The bound with a payload between is at most 3 % above those with none and the greatest.
      EXPECT_GE(next_s - move.start_s, 2.9 * bounds_s[i] + kRandomMovesRest_s);
    }
  }
}

TEST(RandomFastMoves, AreDeterminedByTheSeed) {
  const MoveRecipe recipe = RecipeFor(Rig());
  const RandomMoves once = MakeFastMoves(Rig(), 7, recipe), again = MakeFastMoves(Rig(), 7, recipe);
  EXPECT_EQ(once.experiment.move[3].to_deg, again.experiment.move[3].to_deg);
  EXPECT_EQ(once.experiment.duration_s, again.experiment.duration_s);
  EXPECT_NE(once.experiment.move[3].to_deg,
            MakeFastMoves(Rig(), 8, recipe).experiment.move[3].to_deg);
}

class Ratios : public testing::Test {
 protected:
  Ratios() {
    const RandomMoves drawn = MakeFastMoves(Rig(), 3, RecipeFor(Rig()));
    request.experiment = drawn.experiment;
    request.payload_kg = drawn.payload_kg;
    const std::vector<double> bounds_s = BoundsOf(drawn.experiment, drawn.payload_kg);
    // Over the bound: 2 at the first, 1.2, 1.4, 1.6 later; on target a tenth later.
    for (std::size_t i = 0; i < 4; ++i) {
      const double ratio = i == 0 ? 2.0 : 1.0 + 0.2 * static_cast<double>(i);
      metrics.arrival.push_back({.start_s = drawn.experiment.move[i].start_s,
                                 .at_rest_s = ratio * bounds_s[i],
                                 .on_target_s = (ratio + 0.1) * bounds_s[i]});
    }
  }

  SimulationRequest request{.config = Rig(), .experiment = {}, .payload_kg = {}, .log = {}};
  RunMetrics metrics;
};

TEST_F(Ratios, AreMeansOverTheMovesWithThePayloadOfThePlant) {
  const BoundRatios ratios = RatiosOf(request, metrics);
  EXPECT_NEAR(ratios.first_at_rest, 2.0, 1e-12);
  EXPECT_NEAR(ratios.later_at_rest, 1.4, 1e-12);
  EXPECT_NEAR(ratios.first_on_target, 2.1, 1e-12);
  EXPECT_NEAR(ratios.later_on_target, 1.5, 1e-12);
}

TEST_F(Ratios, AreMissingWhereAMoveNeverRests) {
  metrics.arrival[2].at_rest_s.reset();
  const BoundRatios ratios = RatiosOf(request, metrics);
  EXPECT_NEAR(ratios.first_at_rest, 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(ratios.later_at_rest));
  EXPECT_NEAR(ratios.later_on_target, 1.5, 1e-12);
}

TEST_F(Ratios, AreOfMovesOfTheShortestDurationAlone) {
  request.experiment.move[1].shortest = false;
  EXPECT_TRUE(std::isnan(RatiosOf(request, metrics).first_at_rest));
}

TEST_F(Ratios, AreMissingWhereARunEndedEarly) {
  metrics.arrival.pop_back();
  EXPECT_TRUE(std::isnan(RatiosOf(request, metrics).first_at_rest));
}

SweepRow RowWith(double later) {
  SweepRow row{.completed = true, .trip = {}, .refused = {}};
  row.measure.fill(std::nan(""));
  row.measure[kLaterAtRest] = later;
  return row;
}

// A run of which a move never rests is the slowest of its group.
TEST(SweepSummaryOfRatios, CountsAMissingRatioAsTheLargest) {
  const SweepGroup group = GroupOf({0}, {RowWith(std::nan("")), RowWith(1.5), RowWith(1.3)});
  EXPECT_EQ(group.median[kLaterAtRest], 1.5);
  EXPECT_TRUE(std::isinf(group.most[kLaterAtRest]));
  EXPECT_TRUE(std::isnan(group.median[kFirstAtRest])) << "no run has it";
}

TEST(SweepSummaryOfRatios, ShowsThemOnlyWhereARunHasThem) {
  SweepSummary summary{.axes = {}, .groups = {GroupOf({0}, {RowWith(1.5)})}};
  EXPECT_EQ(summary.Measured().size(), kFirstAtRest + 1);
  EXPECT_EQ(summary.Measured().back(), kLaterAtRest);
}

}  // namespace
}  // namespace flexarm
