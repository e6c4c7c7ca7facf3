// The tip's acceleration against its position, which is independent code.

#include "model/rigid_joint/tip_acceleration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/rigid_joint/rigid_joint_arm.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

// A bent, moving arm: each term of the formula is 0.05 m/s^2 and more.
struct Motion {
  VectorXd q = VectorXd::Zero(8), v = VectorXd::Zero(8), a = VectorXd::Zero(8);
};

Motion Bent() {
  Motion m;
  m.q << 0.4, -0.9, 0.41, -0.88, 0.05, -0.004, 0.07, 0.006;
  m.v << 2.0, -3.0, 2.1, -2.9, 0.9, 0.3, -1.1, 0.4;
  m.a << 7.0, -11.0, 6.0, -9.0, 8.0, -20.0, 15.0, 30.0;
  return m;
}

ArmModel Model(bool foreshortening) {
  ArmParameters p = ThesisRig();
  p.foreshortening = foreshortening;
  return {p, {2, 2}};
}

// Second differences: their error grows with the square of the step, 0.01 m/s^2 measured at 1e-4 s;
// round-off, 4e-16 / 4e-10, is far smaller.
double Differenced(const ArmModel& model, const Motion& m) {
  constexpr double kStep_s = 2e-5;
  const auto tip = [&](double t) -> Vector2d {
    return model.TipPosition(m.q + t * m.v + 0.5 * t * t * m.a);
  };
  const Vector2d a = (tip(kStep_s) - 2.0 * tip(0.0) + tip(-kStep_s)) / (kStep_s * kStep_s);
  const double alpha1 = std::atan(model.link_modes(1).slope_tip.dot(m.q.segment(kPhi1, 2)));
  const double alpha2 = std::atan(model.link_modes(2).slope_tip.dot(m.q.tail(2)));
  const double along = m.q[kTheta1] + alpha1 + m.q[kTheta2] + alpha2;
  return a.dot(Vector2d(-std::sin(along), std::cos(along)));
}

TEST(TipAcceleration, IsTheSecondDifferenceOfTheTipsPosition) {
  for (const bool foreshortening : {false, true}) {
    const ArmModel model = Model(foreshortening);
    const Motion m = Bent();
    EXPECT_NEAR(TipAcceleration(model, m.q, m.v, m.a), Differenced(model, m), 1e-3)
        << foreshortening;
  }
  const Motion m = Bent();
  EXPECT_GT(std::fabs(TipAcceleration(Model(true), m.q, m.v, m.a) -
                      TipAcceleration(Model(false), m.q, m.v, m.a)),
            0.05)
      << "the foreshortening is too small for this test";
}

TEST(TipAcceleration, SmallModelAgreesWithTheArmWithRigidJoints) {
  const ArmModel model = Model(false);
  const RigidJointArm small(ThesisRig());
  const auto reduced = [](const VectorXd& x) {
    RigidJointArm::Vector out;
    out << x.head<2>(), x.tail<4>();
    return out;
  };
  const Motion m = Bent();
  EXPECT_NEAR(small.TipAcceleration(reduced(m.q), reduced(m.v), reduced(m.a)),
              TipAcceleration(model, m.q, m.v, m.a), 1e-10);
}

// Straight at rest: the shoulder moves the tip with a lever of 1.7 m, the elbow with 0.9 m, a
// deflection moves it along +y; a constant rate accelerates it along the link only.
TEST(TipAcceleration, IsPositiveCounterClockwise) {
  const ArmModel model = Model(false);
  const VectorXd none = VectorXd::Zero(8);
  const auto of = [&](int i) { return TipAcceleration(model, none, none, VectorXd::Unit(8, i)); };
  EXPECT_NEAR(of(kTheta1), 0.8 + 0.9, 1e-12);
  EXPECT_NEAR(of(kTheta2), 0.9, 1e-12);
  EXPECT_EQ(of(kTheta3), 0.0);
  EXPECT_NEAR(of(kPhi1 + 2), 1.0, 1e-12);
  EXPECT_NEAR(TipAcceleration(model, none, 3.0 * VectorXd::Unit(8, kTheta1), none), 0.0, 1e-12);
}

}  // namespace
}  // namespace flexarm
