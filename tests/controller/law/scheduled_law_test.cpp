// The gain-scheduled law, and the reference that it follows.

#include "controller/law/scheduled_law.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "controller/law/scheduling_payload.h"
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

using Eigen::Vector2d;
using testing::HasSubstr;

Experiment OneMove(std::array<double, 2> to_deg, std::optional<double> duration_s,
                   double total_s = 8.0) {
  return {.name = "test",
          .text = "",
          .duration_s = total_s,
          .doublet = {},
          .sim_event = {},
          .move = {{.start_s = 0.2,
                    .duration_s = duration_s,
                    .to_deg = to_deg,
                    .profile = MoveProfile::kSeptic}}};
}

ReferenceTable ScheduledTable(const Experiment& experiment,
                              std::array<double, 2> start_rad = {0.0, 0.0}) {
  return {experiment, ShippedPathDesign(), kPeriod_s, start_rad, ShippedLimits()};
}

ScheduledLaw ShippedLaw() {
  return {MakeRigidJointArm(ShippedPathDesign()),
          ShippedPathDesign().scheduled->gains,
          BendingGuard(ShippedRig()),
          ShippedPathDesign().scheduled->max_kg,
          kPeriod_s,
          ShippedRig().safety.torque_limit_nm};
}

Vector2d AskedOf(const ScheduledLaw::State& x, const PayloadKnowledge& knowledge,
                 const std::array<RigidPoint, 3>& path, double rested_s) {
  const ScheduledLaw law = ShippedLaw();
  return law.Torque(x, knowledge, law.ClosedForm(knowledge.payload_kg, path), rested_s);
}

constexpr PayloadKnowledge kKnown = {.payload_kg = 0.3,
                                     .payload_sigma_kg = 0.0,
                                     .friction_nm = {0.16, 0.01},
                                     .mean_nis = 8.0,
                                     .warnings = 0};

TEST(PathReference, GoesFromRestToRestBendingAsWithTheReferencePayload) {
  const ReferenceTable table = ScheduledTable(OneMove({30, -20}, 2.0), {0.1, -0.2});
  const std::array<double, 2> to_rad = {30 * kRadPerDeg, -20 * kRadPerDeg};
  const RigidJointArm arm = MakeRigidJointArm(ShippedPathDesign());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(table.At(0).x_m[i], i == 0 ? 0.1 : -0.2);
    EXPECT_NEAR(table.At(400).x_m[i], to_rad[i], 1e-15);
    EXPECT_EQ(table.At(400).u_m_nm[i], 0.0);
  }
  double bent_m = 0.0;
  for (int k = 0; k <= table.periods(); ++k) {
    const MotionSample expected = QuasiStaticOver(arm, 0.15, table.PathAround(k), kPeriod_s);
    for (int i = 0; i < 12; ++i) {
      ASSERT_EQ(table.At(k).x_m[static_cast<std::size_t>(i)],
                expected.x[static_cast<std::size_t>(i)])
          << k;
    }
    bent_m = std::fmax(bent_m, std::fabs(table.At(k).x_m[2]));
  }
  EXPECT_GT(bent_m, 0.01) << "an arm that does not bend: the test is inconclusive";
}

TEST(PathReference, ThePathAroundASampleMatchesTheMoves) {
  const ReferenceTable table = ScheduledTable(OneMove({30, -20}, 2.0));
  for (const int k : {-3, 0, 10, 11, 60, 109, 110, 111, 400, 500}) {
    const auto path = table.PathAround(k);
    for (int j = 0; j < 3; ++j) {
      const RigidPoint point = table.moves()[0].At(k - 1 + j, kPeriod_s);
      EXPECT_EQ(path[static_cast<std::size_t>(j)].angle_rad, point.angle_rad) << k;
      EXPECT_EQ(path[static_cast<std::size_t>(j)].rate_rad_s, point.rate_rad_s) << k;
    }
  }
}

// Without moves the reference of a law that follows the path must stay at the start, not at zero.
TEST(PathReference, AnExperimentWithoutMovesRestsWhereItStarts) {
  Experiment nothing = OneMove({0, 0}, 1.0);
  nothing.move.clear();
  const ReferenceTable table = ScheduledTable(nothing, {0.1, -0.2});
  for (const RigidPoint& point : table.PathAround(30)) {
    EXPECT_EQ(point.angle_rad, (std::array<double, 2>{0.1, -0.2}));
    EXPECT_EQ(point.rate_rad_s, (std::array<double, 2>{0.0, 0.0}));
  }
}

TEST(PathReference, TheReferenceOfOtherLawsHasThePathToo) {
  const Experiment experiment = OneMove({30, -20}, 2.0);
  const ReferenceTable table(experiment, ShippedDesign(), kPeriod_s, {0.1, -0.2}, ShippedLimits());
  const ReferenceTable scheduled = ScheduledTable(experiment, {0.1, -0.2});
  for (const int k : {0, 10, 11, 60, 111, 400}) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(table.PathAround(k)[j].angle_rad, scheduled.PathAround(k)[j].angle_rad) << k;
      EXPECT_EQ(table.PathAround(k)[j].rate_rad_s, scheduled.PathAround(k)[j].rate_rad_s) << k;
    }
  }
}

TEST(PathReference, AMoveTooFastForTheHeaviestPayloadIsRefusedWithTheShortestDuration) {
  const std::string message =
      MessageOf<RejectedError>([] { ScheduledTable(OneMove({60, 80}, 1.0)); });
  EXPECT_THAT(message, AllOf(HasSubstr("move[0]"), HasSubstr("controller.payload.max_kg"),
                             HasSubstr("the shortest duration_s within the limits is ")));
  const double shortest_s = std::stod(message.substr(message.rfind(' ')));
  EXPECT_NO_THROW(ScheduledTable(OneMove({60, 80}, shortest_s)));
  EXPECT_THROW(ScheduledTable(OneMove({60, 80}, shortest_s - kPeriod_s)), RejectedError);
}

TEST(PathReference, AMoveWithoutDurationKeepsTheShareOfTheLimitsWithTheHeaviestPayload) {
  const ReferenceTable table = ScheduledTable(OneMove({60, 80}, std::nullopt, 20.0));
  const Experiment limit = OneMove({60, 80}, table.moves()[0].periods * kPeriod_s, 20.0);
  MotionLimits share = ShippedLimits();
  for (auto* values :
       {&share.torque_nm, &share.slew_nm_per_s, &share.hub_rate_rad_s, &share.strain}) {
    for (double& value : *values) value *= share.plan_fraction * (1.0 + 1e-9);
  }
  EXPECT_NO_THROW(ReferenceTable(limit, ShippedPathDesign(), kPeriod_s, {0.0, 0.0}, share));
}

TEST(PathReference, RowsOtherThanMovesAreRefused) {
  Experiment doublet = OneMove({10, 10}, 1.0);
  doublet.doublet = {
      {.start_s = 4.0, .duration_s = 1.0, .shape = DoubletShape::kSquare, .move_deg = {5, 5}}};
  EXPECT_THAT(MessageOf<RejectedError>([&] { ScheduledTable(doublet); }),
              AllOf(HasSubstr("doublet[0]"), HasSubstr("[[move]] rows only")));
}

TEST(ScheduledLaw, TheTorqueIsZeroAtRestOnThePath) {
  const auto path = ScheduledTable(OneMove({30, -20}, 2.0)).PathAround(0);
  const ScheduledLaw::State x = ScheduledLaw::State::Zero();
  EXPECT_EQ(AskedOf(x, kKnown, path, 1.0), Vector2d(0.0, 0.0));
}

TEST(ScheduledLaw, TheTorqueIsQuasiStaticPlusFrictionPlusScheduledFeedback) {
  const ReferenceTable table = ScheduledTable(OneMove({30, -20}, 2.0));
  const RigidJointArm arm = MakeRigidJointArm(ShippedPathDesign());
  const GainTable& gains = ShippedPathDesign().scheduled->gains;
  for (const int k : {30, 60, 90}) {
    const auto path = table.PathAround(k);
    const MotionSample desired = QuasiStaticOver(arm, 0.3, path, kPeriod_s);
    ScheduledLaw::State x = desired.State();
    const Vector2d expected(desired.torque_nm[0] + 0.16 * std::tanh(desired.x[6] / 0.05),
                            desired.torque_nm[1] + 0.01 * std::tanh(desired.x[7] / 0.05));
    EXPECT_LT((AskedOf(x, kKnown, path, 0.0) - expected).norm(), 1e-12) << k;
    x[0] -= 0.01;
    x[4] += 0.002;
    const Vector2d corrected = expected + gains.At(0.3, x[1]) * (desired.State() - x);
    EXPECT_LT((AskedOf(x, kKnown, path, 0.0) - corrected).norm(), 1e-12) << k;
  }
}

// The gains that are stable for every payload are used while the payload is uncertain and while the
// arm rests.
TEST(ScheduledLaw, UsesTheRobustGainsForAnUncertainPayload) {
  const auto path = ScheduledTable(OneMove({30, -20}, 2.0)).PathAround(0);
  const ScheduledLaw::State x = -0.01 * ScheduledLaw::State::Unit(0);
  PayloadKnowledge heavy = kKnown;
  heavy.payload_kg = 1.0;
  const Vector2d sure = AskedOf(x, heavy, path, 0.0);
  const GainTable& gains = ShippedPathDesign().scheduled->gains;
  // At rest the friction is compensated for four seconds.
  const Vector2d robust = gains.At(0.15, 0.0) * -x;
  EXPECT_GT((sure - robust).norm(), 0.01) << "the same gains: the test is inconclusive";
  EXPECT_LT((AskedOf(x, heavy, path, 5.0) - robust).norm(), 1e-12);
  heavy.payload_sigma_kg = 0.2;
  EXPECT_LT((AskedOf(x, heavy, path, 0.0) - robust).norm(), 1e-12);
  heavy.payload_sigma_kg = 0.0;
  heavy.mean_nis = 100.0;
  EXPECT_LT((AskedOf(x, heavy, path, 0.0) - robust).norm(), 1e-12);
  heavy.mean_nis = 8.0;
  heavy.warnings = kPayloadModelMismatch | kPayloadNotObservable;
  EXPECT_EQ(AskedOf(x, heavy, path, 0.0), sure) << "NIS and sigma contain these already";
  heavy.warnings = kPayloadAtBound;
  EXPECT_LT((AskedOf(x, heavy, path, 0.0) - robust).norm(), 1e-12)
      << "the payload may be heavier, however small sigma is";
}

// The friction for a large feedback torque, 0.76 of it (tanh 1) for one of a tenth of the friction;
// three quarters of it a second after the move, and none during a move or later than four seconds
// after it.
TEST(ScheduledLaw, AfterAMoveTheFrictionOfTheFeedbackIsCompensated) {
  const auto path = ScheduledTable(OneMove({30, -20}, 2.0)).PathAround(0);
  const Vector2d friction_nm(0.16, 0.01);
  for (const double off_rad : {-0.02, 1e-4}) {
    const ScheduledLaw::State x = off_rad * ScheduledLaw::State::Unit(0);
    PayloadKnowledge slippery = kKnown;
    slippery.payload_kg = 0.1;  // in the range of the robust gains: K is the same at rest
    slippery.friction_nm = {0.0, 0.0};
    PayloadKnowledge rough = slippery;
    rough.friction_nm = {friction_nm[0], friction_nm[1]};
    const auto help = [&](double rested_s) -> Vector2d {
      return AskedOf(x, rough, path, rested_s) - AskedOf(x, slippery, path, rested_s);
    };
    const Vector2d feedback_nm = AskedOf(x, slippery, path, 1.0);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(help(1.0)[i],
                  0.75 * friction_nm[i] * std::tanh(feedback_nm[i] / (0.1 * friction_nm[i])),
                  1e-12);
    }
    EXPECT_GT(std::fabs(help(1.0)[0]), 1e-4) << "no compensation: the test is inconclusive";
    for (const double rested_s : {0.0, 4.0, 5.0, std::numeric_limits<double>::infinity()}) {
      EXPECT_EQ(help(rested_s), Vector2d(0.0, 0.0)) << rested_s;
    }
  }
}

TEST(MotionState, DetectsTheStartOfEachMoveAndTheTimeAtRest) {
  MotionState watch;
  RigidPoint rest{}, moving{};
  moving.rate_rad_s[1] = 0.1;
  EXPECT_FALSE(watch.Take(rest, kPeriod_s));
  EXPECT_TRUE(std::isinf(watch.rested_s())) << "nothing has moved yet";
  EXPECT_TRUE(watch.Take(moving, kPeriod_s));
  EXPECT_FALSE(watch.Take(moving, kPeriod_s)) << "already reported";
  EXPECT_EQ(watch.rested_s(), 0.0);
  for (int k = 0; k < 5; ++k) EXPECT_FALSE(watch.Take(rest, kPeriod_s));
  EXPECT_NEAR(watch.rested_s(), 0.1, 1e-12);
  EXPECT_TRUE(watch.Take(moving, kPeriod_s)) << "the next move";
  watch.Reset();
  EXPECT_TRUE(std::isinf(watch.rested_s()));
}

}  // namespace
}  // namespace flexarm
