#include "controller/law/stop_controller.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/math/dense_decompositions.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

class StopControllerTest : public testing::Test {
 protected:
  // Advances the nominal arm by one sample.
  StateVector Next(const StateVector& x, const Vector2d& torque_nm) const {
    return design_.A * VectorXd(x) + design_.B * torque_nm;
  }

  const Design& design_ = ShippedDesign();
  StopController stop_{design_.K_stop, design_.layout, kPeriod_s};
};

// The slowest pole of A - B K_stop determines the remaining error after 10 s.
TEST_F(StopControllerTest, RegulateBringsTheNominalArmToRestAtTheGoal) {
  StateVector x = StateVector::Zero(12), goal = StateVector::Zero(12);
  x << 0.11, 0.08, -0.05, 1e-3, -0.04, 1e-3, 0.5, 0.4, -0.3, 0.01, 0.2, -0.01;
  goal(0) = -0.4;
  goal(1) = 0.3;
  const double slowest =
      (design_.A - design_.B * design_.K_stop).eigenvalues().cwiseAbs().maxCoeff();
  ASSERT_LT(slowest, 1.0);
  const double at_start = (x - goal).norm();
  for (int k = 0; k < 500; ++k) x = Next(x, stop_.Regulate(x, {-0.4, 0.3}));
  EXPECT_LT((x - goal).norm(), 1e3 * at_start * std::pow(slowest, 500));
  EXPECT_LT((x - goal).norm(), 1e-3);
}

TEST_F(StopControllerTest, AStopStartsWithTheTorqueOfTheStepBefore) {
  StateVector x = StateVector::Zero(12);
  x(6) = 0.8;  // th1'
  stop_.Begin({0.2, -0.1}, {3.0, -1.0});
  EXPECT_LT((stop_.Stop(x) - Vector2d(3.0, -1.0)).norm(), 1e-12);
}

// 2.2 s after its start, for any state.
TEST_F(StopControllerTest, ALongStopEndsWithZeroTorque) {
  StateVector x = StateVector::Zero(12);
  x(6) = 0.8;
  stop_.Begin({0.0, 0.0}, {3.0, -1.0});
  for (int k = 0; k < 105; ++k) EXPECT_NE(stop_.Stop(x), Vector2d(0.0, 0.0)) << k;
  for (int k = 105; k < 111; ++k) stop_.Stop(x);
  EXPECT_EQ(stop_.Stop(x), Vector2d(0.0, 0.0));
}

// The goal follows the hubs: an arm that rests elsewhere is not pulled back.
TEST_F(StopControllerTest, TheGoalFollowsTheHubs) {
  StateVector x = StateVector::Zero(12);
  x(0) = 0.3;
  stop_.Begin({0.0, 0.0}, {0.0, 0.0});
  Vector2d torque_nm = Vector2d::Zero();
  for (int k = 0; k < 80; ++k) torque_nm = stop_.Stop(x);
  const Vector2d held = stop_.Regulate(x, {0.0, 0.0});
  EXPECT_LT(torque_nm.norm(), 0.05 * held.norm());
}

TEST_F(StopControllerTest, ASecondStopDoesNotDependOnTheFirst) {
  StateVector x = StateVector::Zero(12);
  x(6) = 0.8;
  stop_.Begin({0.0, 0.0}, {1.0, 0.0});
  const Vector2d first = stop_.Stop(x);
  for (int k = 0; k < 200; ++k) stop_.Stop(x);
  stop_.Begin({0.0, 0.0}, {1.0, 0.0});
  EXPECT_EQ(stop_.Stop(x), first);
}

}  // namespace
}  // namespace flexarm
