// The amplitude that the energy of bending and motion gives, against vibrations whose amplitude is
// known.

#include "model/rigid_joint/tip_sway.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

constexpr double kPayload_kg = 0.1;

struct Vibration {
  RigidJointArm::Vector shape = RigidJointArm::Vector::Zero();
  double frequency_rad_s = 0.0;
};

// Slowest vibration of the straight arm with locked hubs, its tip moving by one metre: from a
// general eigenvalue solver, where TipSway iterates.
Vibration Slowest(const RigidJointArm& arm) {
  const RigidJointArm::Vector zero = RigidJointArm::Vector::Zero();
  const Eigen::Matrix4d M =
      arm.At(arm.Outboard(kPayload_kg), zero, zero).M.bottomRightCorner<4, 4>();
  const Eigen::Matrix4d K = arm.stiffness().bottomRightCorner<4, 4>();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix4d> solver(K, M);
  Vibration slowest;
  slowest.shape.tail<4>() = solver.eigenvectors().col(0);
  slowest.shape /= arm.TipAcceleration(zero, zero, slowest.shape);
  slowest.frequency_rad_s = std::sqrt(solver.eigenvalues()(0));
  return slowest;
}

class TipSwayTest : public testing::Test {
 protected:
  const RigidJointArm arm_{ThesisRig()};
  const TipSway sway_{arm_, kPayload_kg};
  const Vibration slowest_ = Slowest(arm_);
};

// 1e-9: the inverse iteration gains a factor of the ratio of the two lowest squared frequencies,
// about 20, each time.
TEST_F(TipSwayTest, IsTheAmplitudeOfTheSlowestVibrationInEveryPhase) {
  constexpr double kAmplitude_m = 0.003;
  for (double phase = 0.0; phase < 6.3; phase += 0.4) {
    const RigidJointArm::Vector q = kAmplitude_m * std::cos(phase) * slowest_.shape;
    const RigidJointArm::Vector v =
        -kAmplitude_m * slowest_.frequency_rad_s * std::sin(phase) * slowest_.shape;
    EXPECT_NEAR(sway_.Amplitude_m(q, v), kAmplitude_m, 1e-9 * kAmplitude_m) << phase;
  }
}

TEST_F(TipSwayTest, IsZeroAtRestWhereverTheHubsStand) {
  RigidJointArm::Vector q = RigidJointArm::Vector::Zero();
  q[0] = 1.0;
  q[1] = -2.0;
  EXPECT_EQ(sway_.Amplitude_m(q, RigidJointArm::Vector::Zero()), 0.0);
}

TEST_F(TipSwayTest, CountsTheMotionOfTheHubs) {
  RigidJointArm::Vector v = RigidJointArm::Vector::Zero();
  v[0] = 0.1;
  EXPECT_GT(sway_.Amplitude_m(RigidJointArm::Vector::Zero(), v), 0.01);
}

}  // namespace
}  // namespace flexarm
