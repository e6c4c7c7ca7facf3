// Smooth moves: the table against a double integrator and the reference model.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controller/reference/reference.h"
#include "controller/types/rejected_error.h"
#include "model/math/dense_decompositions.h"
#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

Experiment Moves(std::vector<Move> moves, std::vector<Doublet> doublets = {}) {
  return {.name = "test",
          .text = "",
          .duration_s = 8.0,
          .doublet = std::move(doublets),
          .sim_event = {},
          .move = std::move(moves)};
}

ReferenceTable MoveTable(const Experiment& experiment, std::array<double, 2> start = {0.0, 0.0}) {
  return {experiment, ShippedDesign(), kPeriod_s, start, ShippedLimits()};
}

// Angles and rates of two double integrators of inertia M_r under the table's torques: x_m without
// bending. Of the reference model only M_r is used.
struct RigidMotion {
  std::vector<Eigen::Vector2d> angle, rate;
};

RigidMotion Integrate(const ReferenceTable& table, Eigen::Vector2d angle) {
  RigidMotion motion;
  Eigen::Vector2d rate = Eigen::Vector2d::Zero();
  const Eigen::Matrix2d inverse = ShippedDesign().rigid_inertia_kgm2.inverse();
  for (int k = 0; k <= table.periods(); ++k) {
    motion.angle.push_back(angle);
    motion.rate.push_back(rate);
    const auto& u_m = table.At(k).u_m_nm;
    const Eigen::Vector2d acceleration = inverse * Eigen::Vector2d(u_m[0], u_m[1]);
    angle += kPeriod_s * rate + 0.5 * kPeriod_s * kPeriod_s * acceleration;
    rate += kPeriod_s * acceleration;
  }
  return motion;
}

TEST(Move, GoesThroughItsWayPointsAndRestsThere) {
  const Experiment experiment = Moves({{.start_s = 0.0, .duration_s = 1.6, .to_deg = {40, -20}},
                                       {.start_s = 2.0, .duration_s = 1.0, .to_deg = {25, 60}},
                                       {.start_s = 3.0, .duration_s = 2.0, .to_deg = {0, 0}}});
  const RigidMotion motion = Integrate(MoveTable(experiment, {0.1, -0.2}), {0.1, -0.2});
  for (const Move& move : experiment.move) {
    const auto k =
        static_cast<std::size_t>(std::lround((move.start_s + *move.duration_s) / kPeriod_s));
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(motion.angle[k](i), move.to_deg[static_cast<std::size_t>(i)] * kRadPerDeg, 1e-12)
          << k;
      EXPECT_NEAR(motion.rate[k](i), 0.0, 1e-12) << k;
    }
  }
}

// The angles stay between two set-points: a quintic does not overshoot.
TEST(Move, StaysBetweenItsEnds) {
  const RigidMotion motion = Integrate(
      MoveTable(Moves({{.start_s = 0.2, .duration_s = 1.0, .to_deg = {30, -10}}})), {0, 0});
  for (const Eigen::Vector2d& angle : motion.angle) {
    EXPECT_GE(angle(0), -1e-12);
    EXPECT_LE(angle(0), 30 * kRadPerDeg + 1e-12);
    EXPECT_LE(angle(1), 1e-12);
    EXPECT_GE(angle(1), -10 * kRadPerDeg - 1e-12);
  }
}

// The whole reference model, bending and all, ends at the set-point: the slowest mode has critical
// damping at 42 rad/s, so that 6 s later only round-off is left.
TEST(Move, TheReferenceModelFollowsAndEndsAtTheSetPoint) {
  const ReferenceTable table =
      MoveTable(Moves({{.start_s = 0.0, .duration_s = 1.6, .to_deg = {30, -45}}}));
  Eigen::VectorXd x_m = Eigen::VectorXd::Zero(12);
  for (int k = 0; k <= table.periods(); ++k) {
    const ReferenceSample& sample = table.At(k);
    for (int i = 0; i < 12; ++i) {
      ASSERT_NEAR(sample.x_m[static_cast<std::size_t>(i)], x_m(i), 1e-12) << k;
    }
    x_m = ShippedDesign().Am * x_m +
          ShippedDesign().Bm * Eigen::Vector2d(sample.u_m_nm[0], sample.u_m_nm[1]);
  }
  EXPECT_NEAR(x_m(0), 30 * kRadPerDeg, 1e-10);
  EXPECT_NEAR(x_m(1), -45 * kRadPerDeg, 1e-10);
  for (int i = 2; i < 12; ++i) EXPECT_NEAR(x_m(i), 0.0, 1e-9) << i;
}

TEST(Move, AfterADoubletStartsAtItsEnd) {
  const Doublet doublet{
      .start_s = 0.0, .duration_s = 1.0, .shape = DoubletShape::kSquare, .move_deg = {20, 10}};
  const Doublet later{
      .start_s = 4.0, .duration_s = 1.0, .shape = DoubletShape::kSine, .move_deg = {-5, 5}};
  const RigidMotion motion =
      Integrate(MoveTable(Moves({{.start_s = 2.0, .duration_s = 1.0, .to_deg = {5, 5}},
                                 {.start_s = 6.0, .duration_s = 1.0, .to_deg = {7, 0}}},
                                {doublet, later})),
                {0, 0});
  EXPECT_NEAR(motion.angle[150](0), 5 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(motion.angle[250](1), 10 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(motion.angle.back()(0), 7 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(motion.angle.back()(1), 0.0, 1e-12);
}

// The plan's polynomials and the table describe the same motion: the rigid angles of a
// sampled profile differ from it by the mean over a period, s'' Ts^2 / 8 T^2 = 4e-4 of the way.
TEST(Move, ThePlanGivesTheRigidCoordinate) {
  Experiment experiment = Moves({{.start_s = 0.0, .duration_s = 1.6, .to_deg = {40, -20}},
                                 {.start_s = 2.0, .duration_s = 1.2, .to_deg = {25, 60}}});
  experiment.move[1].profile = MoveProfile::kSeptic;
  const ReferenceTable table = MoveTable(experiment, {0.1, -0.2});
  const RigidMotion motion = Integrate(table, {0.1, -0.2});
  ASSERT_EQ(table.moves().size(), 2U);
  for (const PlannedMove& move : table.moves()) {
    for (int k = move.first; k <= move.first + move.periods; ++k) {
      const RigidPoint point = move.At(k, kPeriod_s);
      for (std::size_t i = 0; i < 2; ++i) {
        const double way = std::fabs(move.to_rad[i] - move.from.angle_rad[i]);
        const Eigen::Vector2d& angle = motion.angle[static_cast<std::size_t>(k)];
        EXPECT_NEAR(point.angle_rad[i], angle(static_cast<Eigen::Index>(i)), 4e-4 * way) << k;
      }
    }
  }
}

// Central differences over h of a period: h^2/6 times the next derivatives but one.
TEST(Move, TheDerivativesOfThePlanAreThoseOfItsAngles) {
  constexpr double h = 1e-3;
  const ReferenceTable table =
      MoveTable(Moves({{.start_s = 0.4, .duration_s = 1.0, .to_deg = {30, -45}}}));
  const PlannedMove& move = table.moves()[0];
  for (double k = 22.5; k < 70.0; k += 3.7) {
    const RigidPoint before = move.At(k - h, kPeriod_s), after = move.At(k + h, kPeriod_s);
    const RigidPoint now = move.At(k, kPeriod_s);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto rate = [&](double a, double b) { return (b - a) / (2.0 * h * kPeriod_s); };
      EXPECT_NEAR(now.rate_rad_s[i], rate(before.angle_rad[i], after.angle_rad[i]), 1e-7);
      EXPECT_NEAR(now.acceleration_rad_s2[i], rate(before.rate_rad_s[i], after.rate_rad_s[i]),
                  1e-6);
      EXPECT_NEAR(now.jerk_rad_s3[i],
                  rate(before.acceleration_rad_s2[i], after.acceleration_rad_s2[i]), 1e-5);
    }
  }
}

// Segments are separated by rests, which may have no duration.
TEST(Move, ASegmentLastsFromRestToRest) {
  const auto move = [](int first, int periods) {
    PlannedMove out{};
    out.first = first;
    out.periods = periods;
    return out;
  };
  const auto segments =
      MotionSegmentsOf({move(10, 50), move(60, 20), move(100, 40), move(120, 60)});
  ASSERT_EQ(segments.size(), 3u);
  EXPECT_EQ(segments[0].first, 10);
  EXPECT_EQ(segments[0].end, 60);
  EXPECT_EQ(segments[1].first, 60) << "from rest, without a pause";
  EXPECT_EQ(segments[1].end, 80);
  EXPECT_EQ(segments[2].first, 100);
  EXPECT_EQ(segments[2].end, 180) << "the last move retargets";
  EXPECT_TRUE(MotionSegmentsOf({}).empty());
}

// A planned reference keeps its share of every limit, and with one period less it would not: both
// by the check over the whole table, not by the search.
TEST(Move, WithoutADurationTakesTheShortestThatKeepsItsShareOfTheLimits) {
  for (const MoveProfile profile : {MoveProfile::kQuintic, MoveProfile::kSeptic}) {
    Experiment experiment = Moves({{.start_s = 0.2, .to_deg = {30, 30}}});
    experiment.move[0].profile = profile;
    const ReferenceTable chosen = MoveTable(experiment);
    MotionLimits share = ShippedLimits();
    for (std::size_t i = 0; i < 2; ++i) {
      for (auto* limit :
           {&share.torque_nm, &share.slew_nm_per_s, &share.hub_rate_rad_s, &share.strain}) {
        (*limit)[i] *= share.plan_fraction;
      }
    }
    const int n = chosen.moves()[0].periods;
    const auto with = [&](int periods) {
      Experiment asked = experiment;
      asked.move[0].duration_s = periods * kPeriod_s;
      return ReferenceTable(asked, ShippedDesign(), kPeriod_s, {0.0, 0.0}, share);
    };
    EXPECT_NO_THROW(with(n)) << n;
    EXPECT_THROW(with(n - 1), RejectedError) << n;
  }
}

// 30/30 deg by a quintic: the strain at the root of link 1 falls with T^2 from 1.16e-3 in 1 s (an
// independent calculation with the golden reference model); 0.6 of 1.9e-3 is 1.14e-3.
TEST(Move, TheShortestDurationIsThatOfTheStrain) {
  const ReferenceTable table = MoveTable(Moves({{.start_s = 0.0, .to_deg = {30, 30}}}));
  EXPECT_NEAR(table.moves()[0].periods * kPeriod_s, 1.0 * std::sqrt(1.16 / 1.14), 0.021);
}

TEST(Move, AChosenDurationIsWrittenIntoTheExperimentAndItsText) {
  Experiment experiment = Moves({{.start_s = 0.0, .duration_s = 1.6, .to_deg = {10, 10}},
                                 {.start_s = 2.0, .to_deg = {-10, 10}}});
  experiment.text = "x = 1";
  const ReferenceTable table = MoveTable(experiment);
  const Experiment chosen = WithChosenDurations(experiment, table.moves(), kPeriod_s);
  EXPECT_NEAR(chosen.move[1].duration_s.value(), table.moves()[1].periods * kPeriod_s, 1e-12);
  EXPECT_THAT(chosen.text, AllOf(testing::StartsWith("x = 1\n"), HasSubstr("[[planned_move]]\n"),
                                 HasSubstr("row = 1\n")));
  experiment.move.push_back({.start_s = 2.2, .to_deg = {0, 0}});
  EXPECT_THROW(MoveTable(experiment), RejectedError)
      << "overlaps the move whose duration was chosen";
}

// Its moves last 1.6 s and some chosen time from 2.0 s on; a second of rest follows.
TEST(Move, ARunWithoutDurationEndsASecondAfterItsLastMove) {
  Experiment experiment = Moves({{.start_s = 0.0, .duration_s = 1.6, .to_deg = {10, 10}},
                                 {.start_s = 2.0, .to_deg = {-10, 10}}});
  experiment.ends_after_rows = true;
  experiment.duration_s = kLongestRun_s;
  const ReferenceTable table = MoveTable(experiment);
  EXPECT_EQ(table.periods(), 100 + table.moves()[1].periods + 50);
  const Experiment chosen = WithChosenDurations(experiment, table.moves(), kPeriod_s);
  EXPECT_NEAR(chosen.duration_s, table.periods() * kPeriod_s, 1e-12);
  EXPECT_THAT(chosen.text, HasSubstr("[planned]\nduration_s = "));
  EXPECT_EQ(WithChosenDurations(chosen, table.moves(), kPeriod_s).text, chosen.text) << "once";
}

TEST(Move, AGoalBeyondASoftLimitIsRefusedByItsName) {
  EXPECT_THAT(
      MessageOf<RejectedError>([] { MoveTable(Moves({{.start_s = 0.0, .to_deg = {20, 100}}})); }),
      HasSubstr("move[0]: its end at [20.0, 100.0] deg is beyond limits.soft_angle_deg, "
                "[90.0, 90.0] deg"));
}

// The tip of two straight links of 0.8 and 0.9 m at th1 = 60, th2 = 60 deg: L1 at 60, L2 at 120.
TEST(Move, GoesToAPositionOfTheTip) {
  const std::array<double, 2> tip = {
      0.8 * std::cos(60 * kRadPerDeg) + 0.9 * std::cos(120 * kRadPerDeg),
      0.8 * std::sin(60 * kRadPerDeg) + 0.9 * std::sin(120 * kRadPerDeg)};
  Experiment experiment = Moves({{.start_s = 0.0, .duration_s = 3.0, .to_tip_m = tip}});
  experiment.move[0].elbow = ElbowSide::kRight;
  const ReferenceTable table = MoveTable(experiment);
  EXPECT_NEAR(table.moves()[0].to_rad[0], 60 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(table.moves()[0].to_rad[1], 60 * kRadPerDeg, 1e-12);
}

std::string MoveRefusal(const Experiment& experiment) {
  return MessageOf<RejectedError>([&] { MoveTable(experiment); });
}

TEST(Move, OffTheGridTooShortOrBeyondTheSoftLimitIsRefused) {
  EXPECT_THAT(MoveRefusal(Moves({{.start_s = 0.01, .duration_s = 1.0, .to_deg = {5, 5}}})),
              HasSubstr("move[0].start_s"));
  EXPECT_THAT(MoveRefusal(Moves({{.start_s = 0.0, .duration_s = 0.18, .to_deg = {5, 5}}})),
              AllOf(HasSubstr("move[0].duration_s"), HasSubstr("at least 10 periods")));
  EXPECT_EQ(MoveRefusal(Moves({{.start_s = 0.0, .duration_s = 0.2, .to_deg = {1, 1}}})), "");
  EXPECT_THAT(MoveRefusal(Moves({{.start_s = 0.0, .duration_s = 2.0, .to_deg = {0, 95}}})),
              AllOf(HasSubstr("move[0]: the angle of joint 2 reaches"),
                    HasSubstr("beyond limits.soft_angle_deg, 90 deg")));
}

TEST(Move, TooFastIsRefusedWithTheLimitAndTheShortestDuration) {
  const Experiment slow = Moves({{.start_s = 0.0, .duration_s = 1.6, .to_deg = {10, 10}},
                                 {.start_s = 2.0, .duration_s = 0.6, .to_deg = {40, 40}}});
  const std::string refusal = MoveRefusal(slow);
  EXPECT_THAT(refusal, AllOf(HasSubstr("move[1]: the strain at the root of link 1 reaches"),
                             HasSubstr("beyond limits.strain_limit, 1900 microstrain"),
                             HasSubstr("the shortest duration_s within the limits is 0.")));
  Experiment repaired = slow;
  repaired.move[1].duration_s = std::stod(refusal.substr(refusal.rfind(' ')));
  EXPECT_EQ(MoveRefusal(repaired), "");
  *repaired.move[1].duration_s -= kPeriod_s;
  EXPECT_NE(MoveRefusal(repaired), "");
}

TEST(Move, ATipOutOfReachOrOfTwoPosesIsRefused) {
  const auto to = [](double x, double y) {
    return MoveRefusal(Moves({{.start_s = 0.0, .duration_s = 3.0, .to_tip_m = {{x, y}}}}));
  };
  EXPECT_THAT(to(1.5, 1.0), AllOf(HasSubstr("move[0].to_tip_m = [1.5, 1]"),
                                  HasSubstr("out of reach"), HasSubstr("1.7 m")));
  EXPECT_THAT(to(1.2, 0.5), AllOf(HasSubstr("two poses"), HasSubstr("elbow")));
  EXPECT_THAT(to(-1.5, 0.0), HasSubstr("no joint angles within limits.soft_angle_deg"));
  EXPECT_EQ(to(0.0, 1.69), "") << "one of the two poses leaves the soft limits";
}

}  // namespace
}  // namespace flexarm
