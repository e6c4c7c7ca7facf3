// The recipe of the design study's random moves, docs/theory/payload.md 6.1.

#include "tools/sweep/random_moves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "config/config.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr double kRad = std::numbers::pi / 180.0;
constexpr double kRoundOff_s = 1e-9;

RigidJointArm Arm() {
  return RigidJointArm(LoadConfig(FLEXARM_SOURCE_DIR "/config/thesis-rig.toml").arm);
}

bool WithinAPeriodAfter(double from_s, double time_s) {
  return time_s >= from_s - kRoundOff_s && time_s <= from_s + kPeriod_s + kRoundOff_s;
}

TEST(RandomMoves, FollowTheRecipe) {
  const RigidJointArm arm = Arm();
  double furthest1_deg = 0.0, furthest2_deg = 0.0, heaviest_kg = 0.0, longest = 0.0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const RandomMoves moves = MakeRandomMoves(arm, seed, 0.3);
    EXPECT_GE(moves.payload_kg, 0.0);
    heaviest_kg = std::max(heaviest_kg, moves.payload_kg);
    ASSERT_EQ(moves.experiment.move.size(), 4U);
    Eigen::Vector2d from_deg = Eigen::Vector2d::Zero();
    double free_s = 0.0;
    for (const Move& move : moves.experiment.move) {
      const Eigen::Vector2d to_deg(move.to_deg[0], move.to_deg[1]);
      furthest1_deg = std::max(furthest1_deg, std::fabs(to_deg[0]));
      furthest2_deg = std::max(furthest2_deg, std::fabs(to_deg[1]));
      EXPECT_EQ(move.profile, MoveProfile::kSeptic);
      EXPECT_TRUE(WithinAPeriodAfter(free_s, move.start_s)) << move.start_s;
      const double ticks = *move.duration_s / kPeriod_s;
      EXPECT_NEAR(ticks, std::round(ticks), 1e-9);
      // One period of tolerance for the rounding up to a sample.
      const double rule_s = RuleDuration_s(arm, 1.0, from_deg * kRad, to_deg * kRad);
      EXPECT_GE(*move.duration_s, rule_s);
      EXPECT_LE(*move.duration_s, 1.5 * rule_s + kPeriod_s);
      longest = std::max(longest, *move.duration_s / rule_s);
      free_s = move.start_s + *move.duration_s + kRandomMovesRest_s;
      from_deg = to_deg;
    }
    EXPECT_TRUE(WithinAPeriodAfter(free_s, moves.experiment.duration_s));
  }
  // 400 samples reach the ends of their ranges.
  EXPECT_TRUE(furthest1_deg > 59.0 && furthest1_deg <= 60.0) << furthest1_deg;
  EXPECT_TRUE(furthest2_deg > 89.0 && furthest2_deg <= 90.0) << furthest2_deg;
  EXPECT_TRUE(heaviest_kg > 0.29 && heaviest_kg <= 0.3) << heaviest_kg;
  EXPECT_GT(longest, 1.45);
}

// mt19937_64's bits are in the standard: its 10000th number from the default seed 5489 is
// 9981545732273789042. Here the first from seed 1, 2469588189546311528 = 0.1338765... of 2^64.
TEST(RandomMoves, AreTheSameOnEveryMachine) {
  const RandomMoves moves = MakeRandomMoves(Arm(), 1, 1.0);
  EXPECT_NEAR(moves.payload_kg, 2469588189546311528.0 / 0x1p64, 1e-15);
  // First the elbow's target, then the shoulder's: published scores depend on this order.
  std::mt19937_64 random(1);
  random.discard(1);
  const double second = static_cast<double>(random()), third = static_cast<double>(random());
  EXPECT_NEAR(moves.experiment.move[0].to_deg[1], 180.0 * second / 0x1p64 - 90.0, 1e-12);
  EXPECT_NEAR(moves.experiment.move[0].to_deg[0], 120.0 * third / 0x1p64 - 60.0, 1e-12);
}

// The recipe of the thesis's rig is the design study's, to the bit.
TEST(MoveRecipe, OfTheThesisRigIsTheDesignStudys) {
  const RigConfig rig = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml");
  const MoveRecipe recipe = RecipeFor(rig);
  const RandomMoves of_rig = MakeRandomMoves(Arm(), 7, recipe),
                    study = MakeRandomMoves(Arm(), 7, 1.0);
  EXPECT_EQ(recipe.grid_s, kMoveGrid_s);
  EXPECT_EQ(of_rig.payload_kg, study.payload_kg);
  for (std::size_t i = 0; i < study.experiment.move.size(); ++i) {
    EXPECT_EQ(of_rig.experiment.move[i].to_deg, study.experiment.move[i].to_deg);
    EXPECT_EQ(of_rig.experiment.move[i].start_s, study.experiment.move[i].start_s);
    EXPECT_EQ(of_rig.experiment.move[i].duration_s, study.experiment.move[i].duration_s);
  }
}

// plan_fraction is 0.6. Targets and payloads within the rig's, 8 ms.
TEST(MoveRecipe, OfAnotherArmKeepsItsLimits) {
  const RigConfig rig = LoadConfig(
      FLEXARM_SOURCE_DIR "/config/hil.toml",
      {"arm.motor2_mass_kg=1.0", "limits.soft_angle_deg=[30, 60]", "limits.hub_rate_rad_s=[2, 3]",
       "controller.payload_range_kg=[0.2, 0.4]", "loop.period_ms=8", "loop.acquire_before_ms=4",
       "loop.step_deadline_ms=2", "loop.output_after_ms=6"});
  const MoveRecipe recipe = RecipeFor(rig);
  EXPECT_EQ(recipe.within_deg, (std::array{2.0 / 3.0 * 30.0, 2.0 / 3.0 * 60.0}));
  EXPECT_EQ(recipe.ability.rate_rad_s, (std::array{0.6 * 2.0, 0.6 * 3.0}));
  EXPECT_NEAR(recipe.grid_s, 0.024, 1e-12) << "the first multiple of 8 ms from 20 ms on";
  const RandomMoves moves = MakeRandomMoves(RigidJointArm(rig.arm), 1, recipe);
  EXPECT_GE(moves.payload_kg, 0.2);
  EXPECT_LE(moves.payload_kg, 0.4);
}

TEST(RandomMoves, HaveTheRequestedNumberAndTheSameBeginning) {
  const RandomMoves four = MakeRandomMoves(Arm(), 1, 1.0),
                    seven = MakeRandomMoves(Arm(), 1, 1.0, 7);
  ASSERT_EQ(seven.experiment.move.size(), 7U);
  EXPECT_EQ(seven.experiment.move[3].to_deg, four.experiment.move[3].to_deg);
}

// Small angles of the heavy elbow: two limits computed by hand. At rest M_tt is symmetric; 7.51 =
// the largest acceleration of s(t) = 35 t^4 - 84 t^5 + 70 t^6 - 20 t^7, 2.19 its largest rate.
TEST(RuleDuration, IsTheShortestThatTorqueAndSpeedAllow) {
  const RigidJointArm arm = Arm();
  const Eigen::Vector2d zero(0.0, 0.0), by(1.0, 0.0);
  RigidJointArm::Vector q = RigidJointArm::Vector::Zero();
  const auto M = arm.At(arm.Outboard(1.0), q, q).M;
  const double of_torque_s = std::sqrt(7.51 * std::max(M(0, 0) / 9.0, std::fabs(M(1, 0)) / 3.8));
  EXPECT_NEAR(RuleDuration_s(arm, 1.0, zero, by), of_torque_s, 1e-12);
  EXPECT_GT(of_torque_s, 2.19 / 4.0) << "the rate would have been the limit";
  EXPECT_EQ(RuleDuration_s(arm, 1.0, zero, 1e-6 * by), 0.4) << "the shortest of all";
  // For very large angles the rate decides: the duration that the torque needs grows only with the
  // root of the angle.
  EXPECT_NEAR(RuleDuration_s(arm, 0.0, zero, -40.0 * by), 2.19 * 40.0 / 4.0, 1e-12);
  EXPECT_NEAR(RuleDuration_s(arm, 0.0, zero, {0.0, -60.0}), 2.19 * 60.0 / 6.0, 1e-12);
}

// The rule takes the worst of both joints over the elbow angles of the path: a straight arm has the
// largest inertia for the shoulder, and the torque at the elbow due to the shoulder's motion grows
// as the elbow bends to the other side.
TEST(RuleDuration, IsThatOfTheWorstOfFivePointsOfThePath) {
  const RigidJointArm arm = Arm();
  const RigidJointArm::Vector at_rest = RigidJointArm::Vector::Zero();
  std::array<int, 2> decides{};
  for (const auto& [from1, from2, to1, to2] : {std::array{0.3, -1.2, -0.4, 0.9},
                                               {-0.5, 1.5, 0.4, 0.2},
                                               {0.2, 0.4, 0.1, -1.1},
                                               {0.9, -0.1, 0.8, 1.4},
                                               {-0.2, 1.4, 0.9, 1.5}}) {
    const Eigen::Vector2d by(to1 - from1, to2 - from2);
    Eigen::Vector2d effort = Eigen::Vector2d::Zero();
    for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      RigidJointArm::Vector q = at_rest;
      q[1] = (1.0 - part) * from2 + part * to2;
      const auto M = arm.At(arm.Outboard(0.7), q, at_rest).M;
      effort[0] = std::max(effort[0], std::fabs(M(0, 0) * by[0] + M(0, 1) * by[1]) / 9.0);
      effort[1] = std::max(effort[1], std::fabs(M(1, 0) * by[0] + M(1, 1) * by[1]) / 3.8);
    }
    ++decides[effort[0] > effort[1] ? 0 : 1];
    EXPECT_NEAR(RuleDuration_s(arm, 0.7, {from1, from2}, {to1, to2}),
                std::sqrt(7.51 * effort.maxCoeff()), 1e-12);
  }
  EXPECT_GT(decides[0], 0);
  EXPECT_GT(decides[1], 0);
}

}  // namespace
}  // namespace flexarm
