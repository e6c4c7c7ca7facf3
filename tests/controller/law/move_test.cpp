// Smooth moves: the profile against the quintic's closed forms, the table against a double
// integrator and the reference model.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/law/motion_profile.h"
#include "controller/law/reference.h"
#include "controller/law/refused.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

constexpr double kPeriod_s = 0.02;
constexpr double kDeg = std::numbers::pi / 180.0;
constexpr std::array<double, 2> kSoft = {90.0 * kDeg, 90.0 * kDeg};

Experiment Moves(std::vector<Move> moves, std::vector<Doublet> doublets = {}) {
  return {.name = "test",
          .text = "",
          .duration_s = 8.0,
          .doublet = std::move(doublets),
          .sim_event = {},
          .move = std::move(moves)};
}

ReferenceTable Table(const Experiment& experiment, std::array<double, 2> start = {0.0, 0.0}) {
  return {experiment, ShippedDesign(), kPeriod_s, start, kSoft};
}

// Angles and rates of two double integrators of inertia M_r under the table's torques: what x_m is
// without bending. They need nothing of the reference model but M_r.
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

// The closed forms hold for n periods as the profile takes T (n - 1)/n; what is left is the
// difference between a mean over two samples and a peak, of order 1/n^2: 40/n^2 covers both.
TEST(QuinticProfile, PeaksAreThoseOfTheClosedForm) {
  for (const int n : {25, 50, 100, 1000}) {
    const std::vector<double> a = QuinticAccelerations(n, kPeriod_s);
    const double T = (n - 1) * kPeriod_s;
    double rate = 0.0, peak_rate = 0.0, peak = 0.0;
    for (const double value : a) {
      rate += value * kPeriod_s;
      peak_rate = std::max(peak_rate, std::fabs(rate));
      peak = std::max(peak, std::fabs(value));
    }
    EXPECT_NEAR(peak_rate * T, 15.0 / 8.0, 40.0 / (n * n)) << n;
    EXPECT_NEAR(peak * T * T, 10.0 / std::sqrt(3.0), 40.0 / (n * n)) << n;
  }
}

// Second differences of numbers up to 1 carry 1e-16 / Ts^2 of round-off each, which the double
// integral turns into 1e-16 n^2 / 2: 1e-12 for 100 periods.
TEST(QuinticProfile, ADoubleIntegratorIsAtRestAtOneWhenItEnds) {
  for (const int n : {10, 11, 50, 99}) {
    double angle = 0.0, rate = 0.0;
    for (const double value : QuinticAccelerations(n, kPeriod_s)) {
      angle += kPeriod_s * rate + 0.5 * kPeriod_s * kPeriod_s * value;
      rate += kPeriod_s * value;
    }
    EXPECT_NEAR(angle, 1.0, 1e-12) << n;
    EXPECT_NEAR(rate, 0.0, 1e-12) << n;
  }
}

TEST(Move, GoesThroughItsWayPointsAndRestsThere) {
  const Experiment experiment = Moves({{.start_s = 0.0, .duration_s = 1.6, .to_deg = {40, -20}},
                                       {.start_s = 2.0, .duration_s = 1.0, .to_deg = {25, 60}},
                                       {.start_s = 3.0, .duration_s = 2.0, .to_deg = {0, 0}}});
  const RigidMotion motion = Integrate(Table(experiment, {0.1, -0.2}), {0.1, -0.2});
  for (const Move& move : experiment.move) {
    const auto k =
        static_cast<std::size_t>(std::lround((move.start_s + move.duration_s) / kPeriod_s));
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(motion.angle[k](i), move.to_deg[static_cast<std::size_t>(i)] * kDeg, 1e-12) << k;
      EXPECT_NEAR(motion.rate[k](i), 0.0, 1e-12) << k;
    }
  }
}

// The angles never leave the way between two set-points: a quintic does not overshoot.
TEST(Move, StaysBetweenItsEnds) {
  const RigidMotion motion =
      Integrate(Table(Moves({{.start_s = 0.2, .duration_s = 1.0, .to_deg = {30, -10}}})), {0, 0});
  for (const Eigen::Vector2d& angle : motion.angle) {
    EXPECT_GE(angle(0), -1e-12);
    EXPECT_LE(angle(0), 30 * kDeg + 1e-12);
    EXPECT_LE(angle(1), 1e-12);
    EXPECT_GE(angle(1), -10 * kDeg - 1e-12);
  }
}

// The whole reference model, bending and all, ends at the set-point: the slowest mode has critical
// damping at 42 rad/s, so that 6 s later only round-off is left.
TEST(Move, TheReferenceModelFollowsAndEndsAtTheSetPoint) {
  const ReferenceTable table =
      Table(Moves({{.start_s = 0.0, .duration_s = 1.6, .to_deg = {30, -45}}}));
  Eigen::VectorXd x_m = Eigen::VectorXd::Zero(12);
  for (int k = 0; k <= table.periods(); ++k) {
    const ReferenceSample& sample = table.At(k);
    for (int i = 0; i < 12; ++i) {
      ASSERT_NEAR(sample.x_m[static_cast<std::size_t>(i)], x_m(i), 1e-12) << k;
    }
    x_m = ShippedDesign().Am * x_m +
          ShippedDesign().Bm * Eigen::Vector2d(sample.u_m_nm[0], sample.u_m_nm[1]);
  }
  EXPECT_NEAR(x_m(0), 30 * kDeg, 1e-10);
  EXPECT_NEAR(x_m(1), -45 * kDeg, 1e-10);
  for (int i = 2; i < 12; ++i) EXPECT_NEAR(x_m(i), 0.0, 1e-9) << i;
}

TEST(Move, AfterADoubletStartsWhereThatEnded) {
  const Doublet doublet{
      .start_s = 0.0, .duration_s = 1.0, .shape = DoubletShape::kSquare, .move_deg = {20, 10}};
  const Doublet later{
      .start_s = 4.0, .duration_s = 1.0, .shape = DoubletShape::kSine, .move_deg = {-5, 5}};
  const RigidMotion motion =
      Integrate(Table(Moves({{.start_s = 2.0, .duration_s = 1.0, .to_deg = {5, 5}},
                             {.start_s = 6.0, .duration_s = 1.0, .to_deg = {7, 0}}},
                            {doublet, later})),
                {0, 0});
  EXPECT_NEAR(motion.angle[150](0), 5 * kDeg, 1e-12);
  EXPECT_NEAR(motion.angle[250](1), 10 * kDeg, 1e-12);
  EXPECT_NEAR(motion.angle.back()(0), 7 * kDeg, 1e-12);
  EXPECT_NEAR(motion.angle.back()(1), 0.0, 1e-12);
}

std::string RefusalOf(const Experiment& experiment) {
  try {
    Table(experiment);
  } catch (const Refused& refused) {
    return refused.what();
  }
  return "accepted";
}

TEST(Move, OffTheGridTooShortOrBeyondTheSoftLimitIsRefused) {
  EXPECT_THAT(RefusalOf(Moves({{.start_s = 0.01, .duration_s = 1.0, .to_deg = {5, 5}}})),
              HasSubstr("move[0].start_s"));
  EXPECT_THAT(RefusalOf(Moves({{.start_s = 0.0, .duration_s = 0.18, .to_deg = {5, 5}}})),
              AllOf(HasSubstr("move[0].duration_s"), HasSubstr("at least 10 periods")));
  EXPECT_EQ(RefusalOf(Moves({{.start_s = 0.0, .duration_s = 0.2, .to_deg = {1, 1}}})), "accepted");
  EXPECT_THAT(RefusalOf(Moves({{.start_s = 0.0, .duration_s = 2.0, .to_deg = {0, 95}}})),
              AllOf(HasSubstr("joint 2"), HasSubstr("soft limit")));
}

}  // namespace
}  // namespace flexarm
