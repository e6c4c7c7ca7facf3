// A path whose speed or goal changes while it is followed: against the path itself, which it must
// not leave, and against differences of its own samples.

#include "controller/reference/motion_change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/reference/path_time.h"
#include "controller/reference/slowed_experiment.h"
#include "controller/types/rejected_error.h"
#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kFrom = 60;  // 1.2 s: the first move is fastest near it

Experiment TwoMoves() {
  return {.name = "test",
          .text = "",
          .duration_s = 6.0,
          .doublet = {},
          .sim_event = {},
          .move = {{.start_s = 0.2, .duration_s = 2.4, .to_deg = {40, -30}},
                   {.start_s = 3.4, .duration_s = 1.6, .to_deg = {20, 10}}}};
}

ReferenceTable TableOf(const Experiment& experiment) {
  return {experiment, ShippedPathDesign(), kPeriod_s, {0.0, 0.0}, ShippedLimits()};
}

ReferenceTable Slower(const ReferenceTable& table, int from, double speed) {
  return WithSpeed(table, from, speed, ShippedPathDesign(), ShippedLimits());
}

RigidPoint PointOf(const ReferenceTable& table, int k) { return table.PathAround(k)[1]; }

double Distance(const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

// How far a point is from the path: the nearest of 20 instants a sample.
double DistanceFromPath(const std::array<double, 2>& angle_rad, const ReferenceTable& path) {
  double nearest = std::numeric_limits<double>::infinity();
  for (double at = 0.0; at <= path.path_plan()->end; at += 0.05) {
    const RigidPoint point = path.path_plan()->AtPathTime(at, kPeriod_s);
    nearest = std::min(nearest, Distance(point.angle_rad, angle_rad));
  }
  return nearest;
}

// Rate, acceleration and jerk are the derivatives of what is before them, by central differences:
// h^2 / 6 times the third derivative of each. Those of the moves are 2, 15 and, of a septic, 150.
void ExpectSmooth(const ReferenceTable& table) {
  for (int k = 1; k < table.periods(); ++k) {
    const auto [before, now, after] = table.PathAround(k);
    for (std::size_t i = 0; i < 2; ++i) {
      constexpr double h = kPeriod_s, h2 = kPeriod_s * kPeriod_s / 6.0;
      ASSERT_NEAR((after.angle_rad[i] - before.angle_rad[i]) / (2 * h), now.rate_rad_s[i],
                  60.0 * h2)
          << k;
      ASSERT_NEAR((after.rate_rad_s[i] - before.rate_rad_s[i]) / (2 * h),
                  now.acceleration_rad_s2[i], 600.0 * h2)
          << k;
    }
  }
}

// Within a change of speed, where no move begins or ends. Its fifth derivative over time is at most
// 1,500 rad/s^5: 0.6 rad/s times 840 / s^4 of the profile's fourth, and what the move adds.
void ExpectJerkOfAcceleration(const ReferenceTable& table, int first, int last) {
  double largest = 0.0;
  for (int k = first + 1; k < last; ++k) {
    const auto [before, now, after] = table.PathAround(k);
    for (std::size_t i = 0; i < 2; ++i) {
      const double difference =
          (after.acceleration_rad_s2[i] - before.acceleration_rad_s2[i]) / (2 * kPeriod_s);
      ASSERT_NEAR(difference, now.jerk_rad_s3[i], 1500.0 * kPeriod_s * kPeriod_s / 6.0) << k;
      largest = std::max(largest, std::fabs(difference));
    }
  }
  EXPECT_GT(largest, 2.0) << "the test is inconclusive";
}

TEST(PathTime, HasTheDerivativesThatItStates) {
  const PathTime time = PathTime(0.8).WithSpeed(100, 0.2, 40);
  for (int k = 101; k < 180; ++k) {
    const PathInstant before = time.At(k - 1), now = time.At(k), after = time.At(k + 1);
    // A sixth of the third derivative: 0.6 / 40^2, 40^3 and 40^4 times that of the profile, whose
    // second, third and fourth derivatives are at most 7.6, 53 and 840.
    EXPECT_NEAR((after.periods - before.periods) / 2, now.rate, 4.8e-4) << k;
    EXPECT_NEAR((after.rate - before.rate) / 2, now.acceleration, 8.3e-5) << k;
    EXPECT_NEAR((after.acceleration - before.acceleration) / 2, now.jerk, 3.3e-5) << k;
  }
  EXPECT_EQ(time.settled(), 140);
  EXPECT_DOUBLE_EQ(time.At(100).periods, 80.0);
  EXPECT_DOUBLE_EQ(time.At(140).periods, 80.0 + 40 * 0.5);
  EXPECT_DOUBLE_EQ(time.At(150).periods, 100.0 + 10 * 0.2);
  EXPECT_EQ(time.At(150).rate, 0.2);
}

TEST(PathTime, CountedFromASampleGoesOnFromThere) {
  const PathTime time = PathTime(1.0).WithSpeed(10, 0.5, 20).CountedFrom(50);
  EXPECT_EQ(time.At(50).periods, 50.0);
  EXPECT_EQ(time.At(60).periods, 55.0);
}

TEST(MotionChange, APauseComesToRestOnThePathAndHoldsThere) {
  const ReferenceTable table = TableOf(TwoMoves());
  const ReferenceTable paused = Slower(table, kFrom, 0.0);
  for (int k = 0; k < kFrom; ++k) {
    EXPECT_EQ(PointOf(paused, k).angle_rad, PointOf(table, k).angle_rad) << k;
  }
  EXPECT_GE(paused.holds_at(), kFrom + 50) << "1 s";
  const RigidPoint rest = PointOf(paused, paused.holds_at());
  EXPECT_EQ(rest.rate_rad_s, (std::array<double, 2>{}));
  EXPECT_EQ(rest.acceleration_rad_s2, (std::array<double, 2>{}));
  EXPECT_EQ(PointOf(paused, paused.periods()).angle_rad, rest.angle_rad);
  EXPECT_GT(Distance(rest.angle_rad, PointOf(table, kFrom).angle_rad), 0.05);
  for (int k = 0; k <= paused.periods(); ++k) {
    // Between two instants of the comparison the path is 1 rad/s / 2 of 1 ms away at most.
    EXPECT_LT(DistanceFromPath(PointOf(paused, k).angle_rad, table), 1e-3) << k;
  }
  ExpectSmooth(paused);
  ExpectJerkOfAcceleration(paused, kFrom, paused.holds_at());
}

TEST(MotionChange, WhatIsResumedEndsWhereThePathDoes) {
  const ReferenceTable table = TableOf(TwoMoves());
  const ReferenceTable paused = Slower(table, kFrom, 0.0);
  const int from = FirstChange(paused, paused.holds_at(), 15);
  EXPECT_EQ(from, paused.holds_at() + kChangeLead);
  const ReferenceTable resumed = Slower(paused, from, 1.0);
  EXPECT_EQ(resumed.holds_at(), std::numeric_limits<int>::max());
  const RigidPoint end = PointOf(resumed, resumed.periods());
  EXPECT_NEAR(end.angle_rad[0], RadFromDeg(20.0), 1e-12);
  EXPECT_NEAR(end.angle_rad[1], RadFromDeg(10.0), 1e-12);
  // The pause and both changes of speed: half of each is lost.
  EXPECT_GT(resumed.periods(), table.periods() + 25 + kChangeLead + 25 - 1);
  ASSERT_EQ(resumed.moves().size(), 2U);
  EXPECT_EQ(resumed.moves()[0].first, 10);
  EXPECT_GT(resumed.moves()[1].first, 170 + 50) << "later by the pause";
  ExpectSmooth(resumed);
}

TEST(MotionChange, AtAShareOfTheSpeedAllTakesLonger) {
  const ReferenceTable table = TableOf(TwoMoves());
  const ReferenceTable half = AtSpeed(table, 0.5, ShippedPathDesign(), ShippedLimits());
  EXPECT_EQ(half.periods(), 2 * table.periods());
  for (int k = 0; k <= table.periods(); ++k) {
    const RigidPoint fast = PointOf(table, k), slow = PointOf(half, 2 * k);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_DOUBLE_EQ(slow.angle_rad[i], fast.angle_rad[i]) << k;
      EXPECT_DOUBLE_EQ(slow.rate_rad_s[i], fast.rate_rad_s[i] / 2) << k;
      EXPECT_DOUBLE_EQ(slow.acceleration_rad_s2[i], fast.acceleration_rad_s2[i] / 4) << k;
      EXPECT_DOUBLE_EQ(slow.jerk_rad_s3[i], fast.jerk_rad_s3[i] / 8) << k;
    }
  }
}

TEST(MotionChange, AChangeOfSpeedIsNotAskedForDuringAnother) {
  const ReferenceTable table = TableOf(TwoMoves());
  const ReferenceTable slower = Slower(table, kFrom, 0.3);
  EXPECT_EQ(FirstChange(slower, kFrom, 15), slower.path_plan()->time.settled());
  EXPECT_EQ(FirstChange(slower, 200, 15), 215);
}

TEST(MotionChange, ANewGoalIsReachedFromTheMotionThatGoesOn) {
  const ReferenceTable table = TableOf(TwoMoves());
  for (const double speed : {1.0, 0.4}) {
    SCOPED_TRACE(speed);
    const ReferenceTable followed =
        speed == 1.0 ? table : AtSpeed(table, speed, ShippedPathDesign(), ShippedLimits());
    const ReferenceTable turned =
        Retargeted(followed, kFrom, {.start_s = 0.0, .to_deg = {-10.0, 25.0}}, ShippedPathDesign(),
                   ShippedLimits());
    for (int k = 0; k <= kFrom; ++k) {
      const RigidPoint was = PointOf(followed, k), is = PointOf(turned, k);
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(is.angle_rad[i], was.angle_rad[i], 1e-12) << k;
        EXPECT_NEAR(is.rate_rad_s[i], was.rate_rad_s[i], 1e-12) << k;
        EXPECT_NEAR(is.acceleration_rad_s2[i], was.acceleration_rad_s2[i], 1e-11) << k;
        EXPECT_NEAR(is.jerk_rad_s3[i], was.jerk_rad_s3[i], 1e-9) << k;
      }
    }
    const RigidPoint end = PointOf(turned, turned.periods());
    EXPECT_NEAR(end.angle_rad[0], RadFromDeg(-10.0), 1e-12);
    EXPECT_NEAR(end.angle_rad[1], RadFromDeg(25.0), 1e-12);
    EXPECT_EQ(end.rate_rad_s, (std::array<double, 2>{}));
    ExpectSmooth(turned);
  }
}

TEST(MotionChange, ANewGoalWhilePausedIsReachedWhenItIsResumed) {
  const ReferenceTable table = TableOf(TwoMoves());
  const ReferenceTable paused = Slower(table, kFrom, 0.0);
  const int from = FirstChange(paused, paused.holds_at(), 15);
  const ReferenceTable turned = Retargeted(paused, from, {.start_s = 0.0, .to_deg = {0.0, 0.0}},
                                           ShippedPathDesign(), ShippedLimits());
  EXPECT_EQ(turned.holds_at(), from) << "still paused";
  EXPECT_NEAR(Distance(PointOf(turned, turned.periods()).angle_rad,
                       PointOf(paused, paused.holds_at()).angle_rad),
              0.0, 1e-12);
  const ReferenceTable resumed = Slower(turned, FirstChange(turned, from, 15), 1.0);
  EXPECT_NEAR(Distance(PointOf(resumed, resumed.periods()).angle_rad, {0.0, 0.0}), 0.0, 1e-12);
  ExpectSmooth(resumed);
}

TEST(MotionChange, WhatIsBeyondALimitIsRefused) {
  const ReferenceTable table = TableOf(TwoMoves());
  const auto refusal = [&](const Move& goal) {
    return MessageOf<RejectedError>(
        [&] { Retargeted(table, kFrom, goal, ShippedPathDesign(), ShippedLimits()); });
  };
  EXPECT_THAT(refusal({.start_s = 0.0, .to_deg = {120.0, 0.0}}), HasSubstr("no duration"));
  EXPECT_THAT(refusal({.start_s = 0.0, .duration_s = 0.4, .to_deg = {-80.0, 0.0}}),
              HasSubstr("the changed path"));
  EXPECT_THAT(refusal({.start_s = 0.0, .to_tip_m = std::array{3.0, 0.0}}),
              HasSubstr("out of reach"));
  // Limits that leave no room for any change of the speed.
  MotionLimits tight = ShippedLimits();
  tight.torque_nm = {0.2, 0.05};
  EXPECT_THAT(
      MessageOf<RejectedError>([&] { WithSpeed(table, kFrom, 0.0, ShippedPathDesign(), tight); }),
      HasSubstr("no change of the speed"));
}

TEST(MotionChange, ARunWithoutAPathOrWithOpenDurationsCannotBeChanged) {
  Experiment fast = TwoMoves();
  for (Move& move : fast.move) {
    move.duration_s.reset();
    move.shortest = move.same_load = true;
  }
  EXPECT_THAT(WhyNoChange(TableOf(fast)), HasSubstr("chosen while it runs"));
  const ReferenceTable modelled(TwoMoves(), ShippedDesign(), kPeriod_s, {0.0, 0.0},
                                ShippedLimits());
  EXPECT_THAT(WhyNoChange(modelled), HasSubstr("does not follow a path"));
  EXPECT_THAT(WhyNoChange(TableOf(TwoMoves())), IsEmpty());
}

TEST(SlowedExperiment, HasAllItsTimesOnTheGrid) {
  Experiment experiment = TwoMoves();
  experiment.doublet = {
      {.start_s = 5.2, .duration_s = 0.2, .shape = DoubletShape::kSquare, .move_deg = {5.0, 0.0}}};
  const Experiment slow = Slowed(experiment, 0.3, kPeriod_s);
  EXPECT_DOUBLE_EQ(slow.move[0].start_s, 0.68) << "0.667 s";
  EXPECT_DOUBLE_EQ(*slow.move[0].duration_s, 8.0);
  EXPECT_DOUBLE_EQ(slow.doublet[0].duration_s, 0.68) << "an even number of periods";
  EXPECT_DOUBLE_EQ(slow.duration_s, 20.0);
  experiment.chirp = {{}};
  EXPECT_THAT(MessageOf<RejectedError>([&] { Slowed(experiment, 0.5, kPeriod_s); }),
              HasSubstr("chirp[0] is a signal in time"));
}

}  // namespace
}  // namespace flexarm
