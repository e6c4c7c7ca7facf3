// The bending guard: what it takes from a torque, and that the direction assumed to be
// "further" is that of the simulated arm.

#include "controller/law/bending_guard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "controller/reference/motion_limits.h"
#include "hal/sim/simulated_rig.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using State = BendingGuard::State;

// The moments at the strain limit, N m: tests/golden/fast-moves.json.
constexpr std::array<double, 2> kMoment_nm = {15.459, 6.598};

// Link `i` bent to a share of its strain limit by its first mode, at rest.
State Bent(int i, double share) {
  const MotionLimits& limits = ShippedLimits();
  const auto link = static_cast<std::size_t>(i);
  State x = State::Zero();
  x[2 + 2 * i] = share * limits.strain[link] / limits.root_strain_per_m[link][0];
  return x;
}

struct Torques {
  Vector2d feedforward_nm, feedback_nm;
};

Torques Limited(const State& x, const Vector2d& feedforward_nm, const Vector2d& feedback_nm) {
  static const BendingGuard guard(ShippedRig());
  Torques out{.feedforward_nm = feedforward_nm, .feedback_nm = feedback_nm};
  guard.Limit(x, &out.feedforward_nm, &out.feedback_nm);
  return out;
}

TEST(BendingGuard, LimitsTheFeedbackOfAStraightArmToAFifthOfTheMoment) {
  const Torques out = Limited(State::Zero(), {10.0, -4.0}, {20.0, 9.0});
  EXPECT_EQ(out.feedforward_nm, Vector2d(10.0, -4.0));
  // The moments of the golden file have five digits.
  EXPECT_NEAR(out.feedback_nm[0], 0.2 * kMoment_nm[0], 1e-4);
  EXPECT_NEAR(out.feedback_nm[1], 0.2 * kMoment_nm[1], 1e-4);
  EXPECT_EQ(Limited(State::Zero(), {0, 0}, {1.0, -0.5}).feedback_nm, Vector2d(1.0, -0.5));
}

TEST(BendingGuard, ABentLinkLeavesLessFeedbackThatBendsItFurtherAndMoreTheOtherWay) {
  for (const int i : {0, 1}) {
    const double room_nm = 0.2 * kMoment_nm[static_cast<std::size_t>(i)];
    for (const double side : {-1.0, 1.0}) {
      SCOPED_TRACE(i);
      const State x = Bent(i, 0.4 * side);
      const Vector2d further = -side * 30.0 * Vector2d::Unit(i);
      // At half of the share at which none is left.
      EXPECT_NEAR(Limited(x, {0, 0}, further).feedback_nm[i], -side * 0.5 * room_nm, 1e-3);
      EXPECT_NEAR(Limited(x, {0, 0}, -further).feedback_nm[i], side * 1.5 * room_nm, 1e-3);
      EXPECT_EQ(Limited(Bent(i, 0.8 * side), {0, 0}, further).feedback_nm[i], 0.0);
      EXPECT_EQ(Limited(Bent(i, 1.5 * side), {0, 0}, further).feedback_nm[i], 0.0);
    }
  }
}

TEST(BendingGuard, TakesTheFeedforwardOfALinkNearItsLimit) {
  const auto left = [](double share) {
    return Limited(Bent(0, share), {-10.0, 0.0}, {0.0, 0.0}).feedforward_nm[0];
  };
  EXPECT_EQ(left(0.74), -10.0);
  EXPECT_NEAR(left(0.875), -5.0, 1e-9);
  EXPECT_EQ(left(1.2), 0.0);
  EXPECT_EQ(Limited(Bent(0, 1.2), {10.0, 0.0}, {0.0, 0.0}).feedforward_nm[0], 10.0);
}

TEST(BendingGuard, LooksAheadByTheRateOfTheStrain) {
  State x = Bent(0, 0.4);
  x[8] = x[2] / 0.037;  // as much again in a quarter of a period of 6.7 Hz
  EXPECT_EQ(Limited(x, {0, 0}, {-5.0, 0.0}).feedback_nm[0], 0.0);
  x[8] = -x[8];
  // The frequency of the golden file has two digits.
  EXPECT_NEAR(Limited(x, {0, 0}, {-5.0, 0.0}).feedback_nm[0], -0.2 * kMoment_nm[0], 0.1);
}

TEST(BendingGuard, ATorqueThatIsNotANumberStaysSo) {
  State x = State::Zero();
  x[2] = std::numeric_limits<double>::quiet_NaN();
  const Vector2d unknown = Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(std::isnan(Limited(x, {0, 0}, unknown).feedback_nm[0]));
}

// The sign of "further", by the plant: an independent program (tests/model) agrees with it.
TEST(BendingGuard, ATorqueBendsTheLinkThatItTurnsToTheOtherSide) {
  const RigConfig config = ShippedRig();
  for (const int joint : {0, 1}) {
    SimulatedRig rig(config.arm, config.sensors, config.sim);
    std::array<double, 2> torque_nm{};
    torque_nm[static_cast<std::size_t>(joint)] = 2.0;
    rig.SetTorque(torque_nm);
    for (std::int64_t t_ns = 0; t_ns < 40'000'000; t_ns += rig.step_ns()) rig.Step();
    const double bent_m = rig.truth().tip_deflection_m[static_cast<std::size_t>(joint)];
    EXPECT_LT(bent_m, -1e-3) << "link " << joint + 1;
  }
}

}  // namespace
}  // namespace flexarm
