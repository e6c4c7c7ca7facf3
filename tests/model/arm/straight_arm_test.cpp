// Angles of the tip's position against the forward kinematics of the flexible arm at rest.

#include "model/arm/straight_arm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/arm/arm_model.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

const ArmModel& Arm() {
  static const ArmModel arm(ThesisRig(), ModeCount{.link1 = 1, .link2 = 1});
  return arm;
}

constexpr std::array<double, 2> kLengths_m = {0.8, 0.9};  // Table 2, L_1 and L_2

Eigen::Vector2d TipAt(const std::array<double, 2>& angle_rad) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(Arm().dof());
  q << angle_rad[0], angle_rad[1], angle_rad[0], angle_rad[1], 0.0, 0.0;
  return Arm().TipPosition(q);
}

// Round-off of a metre through acos: 1e-16 / sin th2, and near the straight arm its square root.
TEST(StraightArm, ForwardKinematicsOfItsAnglesGivesThePosition) {
  for (const double x : {-1.1, -0.3, 0.0, 0.6, 1.2}) {
    for (const double y : {-1.0, -0.2, 0.4, 1.1}) {
      for (const ElbowSide elbow : {ElbowSide::kLeft, ElbowSide::kRight}) {
        const auto angles = StraightArmAngles(kLengths_m, {x, y}, elbow);
        ASSERT_TRUE(angles.has_value()) << x << ' ' << y;
        EXPECT_NEAR(TipAt(*angles)(0), x, 1e-12);
        EXPECT_NEAR(TipAt(*angles)(1), y, 1e-12);
      }
    }
  }
}

// The elbow is at L1 (cos th1, sin th1): left of the line to the tip when the cross product of tip
// and elbow is positive.
TEST(StraightArm, TheElbowIsOnTheRequestedSide) {
  const std::array<double, 2> tip = {0.7, 0.9};
  for (const ElbowSide elbow : {ElbowSide::kLeft, ElbowSide::kRight}) {
    const auto angles = StraightArmAngles(kLengths_m, tip, elbow).value();
    const double cross = tip[0] * std::sin(angles[0]) - tip[1] * std::cos(angles[0]);
    EXPECT_EQ(cross > 0.0, elbow == ElbowSide::kLeft);
    EXPECT_EQ(angles[1] < 0.0, elbow == ElbowSide::kLeft);
  }
}

TEST(StraightArm, APositionOutOfReachGivesNoAngles) {
  for (const double r : {1.701, 0.099, 0.0}) {
    EXPECT_FALSE(StraightArmAngles(kLengths_m, {0.0, r}, ElbowSide::kLeft).has_value()) << r;
  }
  for (const double r : {1.699, 0.101}) {
    EXPECT_TRUE(StraightArmAngles(kLengths_m, {0.0, -r}, ElbowSide::kRight).has_value()) << r;
  }
}

}  // namespace
}  // namespace flexarm
