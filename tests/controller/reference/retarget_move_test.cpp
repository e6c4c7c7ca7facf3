// Moves that retarget during the move before them: their path, their limits and their durations.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controller/reference/motion_check.h"
#include "controller/reference/path_check.h"
#include "controller/reference/path_reference.h"
#include "controller/reference/reference.h"
#include "controller/step/motion_state.h"
#include "controller/types/rejected_error.h"
#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Experiment PathMoves(std::vector<Move> moves) {
  return {.name = "test",
          .text = "",
          .duration_s = 12.0,
          .doublet = {},
          .sim_event = {},
          .move = std::move(moves)};
}

ReferenceTable PathTable(const Experiment& experiment,
                         const MotionLimits& limits = ShippedLimits()) {
  return {experiment, ShippedPathDesign(), kPeriod_s, {0.0, 0.0}, limits};
}

std::string PathRefusal(const Experiment& experiment,
                        const MotionLimits& limits = ShippedLimits()) {
  return MessageOf<RejectedError>([&] { PathTable(experiment, limits); });
}

// A move, a new target during it, and another one during that.
Experiment Chain() {
  return PathMoves(
      {{.start_s = 0.2, .duration_s = 2.4, .to_deg = {40, -30}, .profile = MoveProfile::kSeptic},
       {.start_s = 1.4, .duration_s = 2.6, .to_deg = {-20, 50}},
       {.start_s = 2.6, .duration_s = 3.0, .to_deg = {25, 10}},
       {.start_s = 8.0, .duration_s = 2.4, .to_deg = {0, 0}}});
}

TEST(Retarget, EachMoveBeginsWithTheStateOfThePathBeforeIt) {
  const ReferenceTable table = PathTable(Chain());
  ASSERT_EQ(table.moves().size(), 4U);
  const std::array<int, 4> first = {10, 70, 130, 400}, periods = {120, 130, 150, 120};
  for (std::size_t i = 0; i < 4; ++i) {
    const PlannedMove& move = table.moves()[i];
    EXPECT_EQ(move.first, first[i]);
    EXPECT_EQ(move.periods, periods[i]) << "as planned, although it is retargeted";
    EXPECT_EQ(move.retargets, i == 1 || i == 2);
    if (!move.retargets) continue;
    const RigidPoint before = table.moves()[i - 1].At(first[i], kPeriod_s);
    EXPECT_EQ(move.from.angle_rad, before.angle_rad);
    EXPECT_EQ(move.from.rate_rad_s, before.rate_rad_s);
    EXPECT_EQ(move.from.acceleration_rad_s2, before.acceleration_rad_s2);
    EXPECT_EQ(move.from.jerk_rad_s3, before.jerk_rad_s3);
    EXPECT_GT(std::fabs(before.rate_rad_s[0]), 0.2) << "it rests: the test is inconclusive";
  }
}

// From sample to sample by Taylor's series up to Y''': what is left is Ts^n / n! times a fourth
// derivative of at most 300 rad/s^4 (septics of 1 rad and 1 rad/s in 2.4 s). A jump of a tenth of
// Y''' = 5 rad/s^3 at a retargeting would change the acceleration by 0.01 rad/s^2.
TEST(Retarget, ThePathIsSmoothAtEveryRetargeting) {
  const ReferenceTable table = PathTable(Chain());
  constexpr double h = kPeriod_s, fourth = 300.0;
  for (int k = 1; k < table.periods(); ++k) {
    const auto [before, now, after] = table.PathAround(k);
    for (std::size_t i = 0; i < 2; ++i) {
      for (const double s : {-1.0, 1.0}) {
        const RigidPoint& there = s > 0 ? after : before;
        const double v = now.rate_rad_s[i], a = now.acceleration_rad_s2[i], j = now.jerk_rad_s3[i];
        ASSERT_NEAR(there.angle_rad[i],
                    now.angle_rad[i] + s * h * v + h * h * a / 2 + s * h * h * h * j / 6,
                    fourth * h * h * h * h / 24)
            << k;
        ASSERT_NEAR(there.rate_rad_s[i], v + s * h * a + h * h * j / 2, fourth * h * h * h / 6)
            << k;
        ASSERT_NEAR(there.acceleration_rad_s2[i], a + s * h * j, fourth * h * h / 2) << k;
        ASSERT_NEAR(there.jerk_rad_s3[i], j, fourth * h) << k;
      }
    }
  }
}

TEST(Retarget, ThePathIsThatOfTheLastMoveThatHasBegunAndRestsAtItsEnd) {
  const ReferenceTable table = PathTable(Chain());
  for (const auto& [k, i] : {std::pair{69, 0}, {71, 1}, {129, 1}, {131, 2}, {279, 2}, {420, 3}}) {
    const RigidPoint point = table.moves()[static_cast<std::size_t>(i)].At(k, kPeriod_s);
    EXPECT_EQ(table.PathAround(k)[1].angle_rad, point.angle_rad) << k;
    EXPECT_NE(table.PathAround(k)[1].rate_rad_s, (std::array<double, 2>{})) << k;
  }
  for (const int k : {280, 281, 400}) {
    const RigidPoint rest = table.PathAround(k)[1];
    EXPECT_EQ(rest.angle_rad, (std::array{25 * kRadPerDeg, 10 * kRadPerDeg})) << k;
    EXPECT_EQ(rest.rate_rad_s, (std::array<double, 2>{})) << k;
    EXPECT_EQ(rest.acceleration_rad_s2, (std::array<double, 2>{})) << k;
  }
}

// With quintic rows the jerk is that of the quintic at that instant.
TEST(Retarget, RetargetingAQuinticMoveKeepsItsJerk) {
  Experiment experiment = Chain();
  experiment.move[0].profile = MoveProfile::kQuintic;
  const ReferenceTable table = PathTable(experiment);
  const RigidPoint quintic = table.moves()[0].At(70, kPeriod_s);
  EXPECT_EQ(table.moves()[1].from.jerk_rad_s3, quintic.jerk_rad_s3);
  EXPECT_NEAR(table.moves()[1].At(70, kPeriod_s).jerk_rad_s3[0], quintic.jerk_rad_s3[0], 1e-9);
}

// A moving arm cannot have been loaded: the estimator must not raise its uncertainty again.
TEST(Retarget, IsNoStartOfAMoveForTheEstimator) {
  const ReferenceTable table = PathTable(Chain());
  MotionState watch;
  std::vector<int> begins;
  for (int k = 0; k <= table.periods(); ++k) {
    if (watch.Take(table.PathAround(k)[1], kPeriod_s)) begins.push_back(k);
  }
  EXPECT_EQ(begins, (std::vector{11, 401}));
}

TEST(Retarget, ALawThatFollowsNoPathRefusesItAndNamesThoseThatDo) {
  const auto refusal = [](const Experiment& experiment) {
    return MessageOf<RejectedError>([&] {
      ReferenceTable(experiment, ShippedDesign(), kPeriod_s, {0.0, 0.0}, ShippedLimits());
    });
  };
  EXPECT_THAT(refusal(Chain()), AllOf(HasSubstr("move[1].start_s = 1.4 s"),
                                      HasSubstr("before the move above it ends, at 2.6 s"),
                                      HasSubstr("controller.name = \"gain-scheduled\"")));
  Experiment apart = Chain();
  apart.move = {apart.move[0], apart.move[3]};
  EXPECT_EQ(refusal(apart), "");
  apart.move[1].start_s = 2.6;
  EXPECT_EQ(refusal(apart), "") << "begins when the other move ends";
}

MotionLimits Share(double share) {
  MotionLimits limits = ShippedLimits();
  for (auto* values :
       {&limits.torque_nm, &limits.slew_nm_per_s, &limits.hub_rate_rad_s, &limits.strain}) {
    for (double& value : *values) value *= share;
  }
  return limits;
}

// By the check over the whole path, not by the search: one period less breaks a limit.
TEST(Retarget, WithoutADurationItTakesTheShortestThatKeepsItsShareOfTheLimits) {
  Experiment experiment = Chain();
  experiment.move.resize(2);
  for (Move& move : experiment.move) move.duration_s.reset();
  const ReferenceTable chosen = PathTable(experiment);
  const MotionLimits limits = Share(ShippedLimits().plan_fraction * (1.0 + 1e-9));
  for (std::size_t i = 0; i < 2; ++i) {
    experiment.move[i].duration_s = chosen.moves()[i].periods * kPeriod_s;
  }
  EXPECT_EQ(PathRefusal(experiment, limits), "");
  *experiment.move[1].duration_s -= kPeriod_s;
  EXPECT_THAT(PathRefusal(experiment, limits), HasSubstr("move[1]: "));
}

TEST(Retarget, TooFastIsRefusedWithTheShortestDurationFromThere) {
  Experiment experiment = Chain();
  experiment.move[1].duration_s = 0.6;
  experiment.move.resize(2);
  const std::string refusal = PathRefusal(experiment);
  EXPECT_THAT(refusal, AllOf(HasSubstr("move[1]: the "), HasSubstr("reaches"),
                             HasSubstr("controller.payload.max_kg"),
                             HasSubstr("the shortest duration_s within the limits is ")));
  experiment.move[1].duration_s = std::stod(refusal.substr(refusal.rfind(' ')));
  EXPECT_EQ(PathRefusal(experiment), "");
  *experiment.move[1].duration_s -= kPeriod_s;
  EXPECT_NE(PathRefusal(experiment), "");
}

// An arm that has to come back slowly first goes on, the farther the longer the duration.
TEST(Retarget, TooSlowIsRefusedAsItLeavesTheSoftLimits) {
  Experiment experiment = PathMoves({{.start_s = 0.2, .duration_s = 2.4, .to_deg = {80, 0}},
                                     {.start_s = 1.16, .duration_s = 5.0, .to_deg = {70, 0}}});
  const std::string refusal = PathRefusal(experiment);
  EXPECT_THAT(refusal, AllOf(HasSubstr("move[1]: the angle of joint 1 reaches"),
                             HasSubstr("beyond limits.soft_angle_deg, 90 deg")));
  const double shortest_s = std::stod(refusal.substr(refusal.rfind(' ')));
  EXPECT_LT(shortest_s, 5.0);
  experiment.move[1].duration_s = shortest_s;
  EXPECT_EQ(PathRefusal(experiment), "");
}

// At 40 of 80 deg, at the highest rate, with a soft limit at 42 deg.
TEST(Retarget, IsRefusedWhereNoDurationKeepsTheLimits) {
  Experiment experiment = PathMoves({{.start_s = 0.2, .duration_s = 2.4, .to_deg = {80, 0}},
                                     {.start_s = 1.4, .duration_s = 2.0, .to_deg = {10, 0}}});
  MotionLimits limits = ShippedLimits();
  limits.soft_angle_rad[0] = 42 * kRadPerDeg;
  EXPECT_THAT(PathRefusal(experiment, limits),
              AllOf(HasSubstr("move[1]: the angle of joint 1"),
                    HasSubstr("no duration_s up to 60 keeps the limits where the move retargets")));
  experiment.move[1].duration_s.reset();
  EXPECT_THAT(PathRefusal(experiment, limits),
              AllOf(HasSubstr("move[1].duration_s: no duration up to 60 s"),
                    HasSubstr("retargets at [40."), HasSubstr("goes to [10.0, 0.0] deg")));
}

// Where a path turns round, the hubs of a heavy arm stay behind and those of a light one reach Y:
// both are checked, and those of any other payload are between. 0.02 deg are allowed for the effect
// of a payload on the other joint.
TEST(Retarget, AngleLimitsHoldForLightArmsToo) {
  const ReferenceTable table =
      PathTable(PathMoves({{.start_s = 0.2, .duration_s = 2.4, .to_deg = {80, 0}},
                           {.start_s = 1.6, .duration_s = 3.0, .to_deg = {40, 0}}}));
  const RigidPath path(table.moves(), {0.0, 0.0}, table.periods(), kPeriod_s);
  const RigidJointArm arm = MakeRigidJointArm(ShippedPathDesign());
  const auto farthest = [&](double payload_kg) {
    double angle_rad = 0.0;
    for (const ReferenceSample& sample :
         QuasiStaticReference(path, arm, payload_kg, kPeriod_s, 0, table.periods())) {
      angle_rad = std::max(angle_rad, sample.x_m[0]);
    }
    return angle_rad;
  };
  double farthest_Y = 0.0;
  for (int k = 0; k <= table.periods(); ++k) {
    farthest_Y = std::max(farthest_Y, path.At(k).angle_rad[0]);
  }
  const double heavy = farthest(1.0);
  ASSERT_LT(heavy, farthest_Y - 0.5 * kRadPerDeg) << "no difference: the test is inconclusive";
  for (const double payload_kg : {0.0, 0.05, 0.15, 0.4}) {
    EXPECT_GT(farthest(payload_kg), heavy) << payload_kg;
    EXPECT_LT(farthest(payload_kg), farthest_Y + 0.02 * kRadPerDeg) << payload_kg;
  }
  MotionLimits limits = ShippedLimits();
  limits.soft_angle_rad[0] = 0.5 * (heavy + farthest_Y);
  const PathCheck check(ShippedPathDesign(), limits, LimitShares::Of(1.0), kPeriod_s);
  const auto broken = check.First(path, 0, table.periods());
  ASSERT_TRUE(broken.has_value());
  EXPECT_THAT(broken->text, AllOf(HasSubstr("the angle of joint 1"), Not(HasSubstr("max_kg"))));
  limits.soft_angle_rad[0] = farthest_Y;
  EXPECT_FALSE(check.First(path, 0, table.periods()).has_value());
}

}  // namespace
}  // namespace flexarm
