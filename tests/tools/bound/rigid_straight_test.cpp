#include "tools/bound/rigid_straight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "controller/types/rejected_error.h"
#include "tests/support/message_of.h"
#include "tests/tools/bound/golden_moves.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

// tests/golden/bounds.json has three decimals: half of the last is 0.17 % of the shortest, 0.301 s.
// Grids and rounded limits (15.459 N m) are the rest.
TEST(RigidStraight, AgreesWithAnotherProgramOnEveryMove) {
  const RigidJointArm arm(BoundRig().arm);
  const nlohmann::json moves = GoldenMoves();
  for (const auto& golden : moves) {
    const double expected_s = golden["rigid_straight_s"];
    EXPECT_NEAR(RigidStraight_s(arm, GoldenLimits(), MoveOf(golden)), expected_s,
                5e-4 + 1e-3 * expected_s)
        << golden;
  }
}

// The elbow alone, about a shoulder that the path holds at rest, and no torque of the shoulder
// limits it: M22 th2'' = u, T = 2 sqrt(M22 D / u). M22 does not depend on the elbow.
TEST(RigidStraight, OfTheElbowAloneIsThatOfADoubleIntegrator) {
  const RigidJointArm arm(BoundRig().arm);
  BoundLimits limits = GoldenLimits();
  limits.torque_nm[0] = limits.root_moment_nm[0] = 1e6;
  limits.hub_rate_rad_s = {1e3, 1e3};
  const RestMove move{.from_rad = {0.0, -0.5}, .to_rad = {0.0, 0.5}, .payload_kg = 0.3};
  const auto inertia =
      arm.At(arm.Outboard(0.3), RigidJointArm::Vector::Zero(), RigidJointArm::Vector::Zero());
  const double expected_s = 2.0 * std::sqrt(inertia.M(1, 1) / limits.torque_nm[1]);
  EXPECT_NEAR(RigidStraight_s(arm, limits, move), expected_s, 1e-9);  // round-off of 1000 sums
}

TEST(RigidStraight, IsTheSameBackwards) {
  const RigidJointArm arm(BoundRig().arm);
  const RestMove move{.from_rad = {-0.3, 0.7}, .to_rad = {0.6, -0.5}, .payload_kg = 0.2};
  const RestMove back{.from_rad = move.to_rad, .to_rad = move.from_rad, .payload_kg = 0.2};
  // Exactly, where the largest z is unique; 1e-6 for a switch at another of two equal pieces.
  const double there_s = RigidStraight_s(arm, GoldenLimits(), move);
  EXPECT_NEAR(RigidStraight_s(arm, GoldenLimits(), back), there_s, 1e-6 * there_s);
}

TEST(RigidStraight, KeepsEveryLimitAndIsHeldUpByOne) {
  const RigidJointArm arm(BoundRig().arm);
  const BoundLimits limits = GoldenLimits();
  const RestMove move{.from_rad = {-0.9, -1.2}, .to_rad = {0.9, 1.2}, .payload_kg = 0.0};
  const MotionTrace trace = RigidStraightMotion(arm, limits, move);
  double held_s = 0.0;
  for (std::size_t k = 0; k + 1 < trace.size(); ++k) {
    const TracePoint& now = trace[k];
    double most = 0.0;
    for (int i = 0; i < 2; ++i) {
      const auto at = static_cast<std::size_t>(i);
      most = std::max({most, std::fabs(now.torque_nm[i]) / limits.rigid_torque_nm()[at],
                       std::fabs(now.rate_rad_s[i]) / limits.hub_rate_rad_s[at]});
    }
    EXPECT_LE(most, 1.0 + 1e-9) << k;
    if (most > 0.999) held_s += trace[k + 1].time_s - now.time_s;
  }
  EXPECT_GT(held_s, 0.98 * trace.back().time_s);  // the fastest motion is at a limit all the time
  EXPECT_NEAR((trace.back().angle_rad - move.to_rad).norm(), 0.0, 1e-12);
  EXPECT_EQ(trace.back().rate_rad_s.norm(), 0.0);
}

TEST(RigidStraight, IsShorterWithMoreTorqueBySquareRoot) {
  const RigidJointArm arm(BoundRig().arm);
  BoundLimits limits = GoldenLimits();
  limits.hub_rate_rad_s = {1e3, 1e3};
  const RestMove move{.from_rad = {0.0, 0.0}, .to_rad = {0.5, 0.5}, .payload_kg = 0.1};
  const double once_s = RigidStraight_s(arm, limits, move);
  for (std::size_t i = 0; i < 2; ++i) {
    limits.torque_nm[i] *= 4.0;
    limits.root_moment_nm[i] *= 4.0;
  }
  EXPECT_NEAR(RigidStraight_s(arm, limits, move), 0.5 * once_s, 1e-9);  // time scales, exactly
}

TEST(BoundLimits, AreThoseOfTheStudyForTheThesisRig) {
  const BoundLimits limits = GoldenLimits();
  // fastmoves: EI strain / (h/2) = 15.459, 6.598 N m; 28 and 5.6 N m; half of the last digit.
  EXPECT_NEAR(limits.root_moment_nm[0], 15.459, 5e-4);
  EXPECT_NEAR(limits.root_moment_nm[1], 6.598, 5e-4);
  EXPECT_NEAR(limits.torque_nm[0], 28.0, 1e-12);
  EXPECT_NEAR(limits.torque_nm[1], 5.6, 1e-12);
  EXPECT_NEAR(limits.rigid_torque_nm()[0], 15.459, 5e-4);
  EXPECT_NEAR(limits.root_strain_per_m[0][0], 0.01051582949, 1e-9);
  EXPECT_NEAR(limits.root_strain_per_m[1][1], -0.1124918492, 1e-9);
  EXPECT_EQ(PlanTorqueShare(BoundRig()), 0.93);  // controller.plan.torque_share
}

TEST(CheckMove, RefusesWhatTheRigDoesNotDo) {
  const auto refusal = [](const Eigen::Vector2d& from_rad, const Eigen::Vector2d& to_rad,
                          double payload_kg) {
    return MessageOf<RejectedError>([&] { CheckMove(BoundRig(), {from_rad, to_rad, payload_kg}); });
  };
  EXPECT_THAT(refusal({0.0, 0.0}, {0.0, 1.6}, 0.1), HasSubstr("end of the move has joint 2"));
  EXPECT_THAT(refusal({-1.6, 0.0}, {0.0, 0.0}, 0.1), HasSubstr("limits.soft_angle_deg"));
  EXPECT_THAT(refusal({0.1, 0.2}, {0.1, 0.2}, 0.1), HasSubstr("ends where it begins"));
  EXPECT_THAT(refusal({0.0, 0.0}, {0.5, 0.5}, 1.2), HasSubstr("controller.payload_range_kg"));
  EXPECT_THAT(refusal({0.0, 0.0}, {0.5, 0.5}, std::nan("")), HasSubstr("payload"));
  EXPECT_NO_THROW(CheckMove(BoundRig(), {{0.0, 0.0}, {0.5, 0.5}, 1.0}));
}

}  // namespace
}  // namespace flexarm
