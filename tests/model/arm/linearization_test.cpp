#include "model/arm/linearization.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/math/dense_decompositions.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// Away from any equilibrium: rates, bending, torque. Differences of fourth order of accelerations
// of 1e4 with a mass matrix of condition 4e4: round-off is 1e-6 of the largest entry of a column;
// a missing dM/dq a leaves 1e-2.
class AnyArm : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Links, AnyArm, testing::Bool(), [](const auto& shown) {
  return shown.param ? "ForeshortenedWithPlayAndFriction" : "AsTheThesis";
});

TEST_P(AnyArm, JacobiansMatchCentralDifferencesAtAMovingState) {
  ArmParameters p = ThesisRig();
  const double k = GetParam() ? 0.7 : 0.0;  // of tanh(k th'), s/rad
  if (GetParam()) {
    p.foreshortening = true;
    p.joint2_backlash = {BacklashModel::kDeadZone, 0.01, 0.2};  // on a flank, by 0.015 rad
  }
  const ArmModel arm(p, {2, 2});
  const Eigen::Index n = arm.dof();
  VectorXd q(n), v(n);
  q << 0.3, -0.8, 0.31, -0.82, 0.02, -0.001, 0.015, 0.002;
  v << 1.0, -3.0, 1.1, -2.9, 0.2, 0.02, -0.3, 0.04;
  const Vector2d torque(2.0, -0.5);
  const LinearModel linear = Linearize(arm, q, v, torque, k);
  const auto rate = [&](const VectorXd& x, const Vector2d& u) {
    VectorXd out(2 * n), force = arm.InputMatrix() * u;
    force[kTheta1] -= 0.16 * std::tanh(k * x[n + kTheta1]);
    force[kTheta2] -= 0.01 * std::tanh(k * x[n + kTheta2]);
    out << x.tail(n), arm.Acceleration(x.head(n), x.tail(n), force);
    return out;
  };
  VectorXd x(2 * n);
  x << q, v;
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    const double h = i % n < kPhi1 ? 1e-4 : 1e-6;
    const auto central = [&](double step) {
      const VectorXd d = step * VectorXd::Unit(2 * n, i);
      return VectorXd((rate(x + d, torque) - rate(x - d, torque)) / (2.0 * step));
    };
    const VectorXd expected = (4.0 * central(h) - central(2.0 * h)) / 3.0;
    EXPECT_LT((linear.A.col(i) - expected).cwiseAbs().maxCoeff(),
              1e-6 * linear.A.col(i).cwiseAbs().maxCoeff())
        << "column " << i;
  }
  for (Eigen::Index i = 0; i < 2; ++i) {
    const VectorXd expected = rate(x, torque + Vector2d::Unit(i)) - rate(x, torque);
    EXPECT_LT((linear.B.col(i) - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST(Linearize, EigenvaluesAtRestAreTheUndampedFrequencies) {
  ArmParameters p = ThesisRig();
  p.damping = DampingReading::kNone;
  const ArmModel arm(p, {2, 2});
  VectorXd q = VectorXd::Zero(8);
  q[kTheta2] = q[kTheta4] = 0.6;
  const MatrixXd A = Linearize(arm, q, VectorXd::Zero(8), Vector2d::Zero()).A;
  VectorXd imaginary = A.eigenvalues().imag();
  std::sort(imaginary.data(), imaginary.data() + imaginary.size());
  const VectorXd expected = FreeMotorFrequenciesHz(arm, 0.6);
  for (Eigen::Index i = 0; i < 6; ++i) {
    EXPECT_NEAR(imaginary[10 + i] / (2.0 * M_PI) / expected[i], 1.0, 1e-8);
  }
}

struct WholeArmRow {
  double payload, theta2_deg;
  double hz[4];
};

// Exact dynamic stiffness of the whole arm (docs/theory/plant.md 6.2; a 40-element FE model agrees
// to 4e-6) with the stated errors of assumed modes: M = 2: .019 .106 .490 .048 %, M = 4: <= .001 %.
TEST(Frequencies, FreeMotorsConvergeToTheExactArm) {
  const WholeArmRow rows[] = {{0.0, 0.0, {7.919741415, 8.758506393, 16.68020545, 21.31146624}},
                              {0.1, 0.0, {6.620644715, 8.758385487, 16.67434804, 17.35428850}},
                              {0.1, 90.0, {6.620507610, 8.757020796, 16.67754998, 17.25650598}}};
  for (const auto basis : {Link1TipInertia::kMotor, Link1TipInertia::kMotorAndRotor}) {
    for (const WholeArmRow& row : rows) {
      ArmParameters p = ThesisRig();
      p.link1_tip_inertia = basis;
      p.payload_mass_kg = p.shape_payload_mass_kg = row.payload;
      const double theta2 = row.theta2_deg * M_PI / 180.0;
      const VectorXd two = FreeMotorFrequenciesHz(ArmModel(p, {2, 2}), theta2);
      const VectorXd four = FreeMotorFrequenciesHz(ArmModel(p, {4, 4}), theta2);
      const VectorXd mirrored = FreeMotorFrequenciesHz(ArmModel(p, {4, 4}), M_PI - theta2);
      for (Eigen::Index i = 0; i < 4; ++i) {
        const double exact = row.hz[i];
        EXPECT_NEAR(four[i] / exact, 1.0, 1.2e-5) << exact;
        EXPECT_NEAR(two[i] / exact, 1.0, 5.5e-3) << exact;
        EXPECT_GT(four[i], exact * (1.0 - 5e-6)) << "Rayleigh-Ritz converges from above";
        EXPECT_NEAR(mirrored[i] / four[i], 1.0, 1e-10) << "th2 and 180 - th2 coincide";
      }
    }
  }
}

// docs/theory/plant.md 6.3: error of f1..f4 of the assumed modes against the exact arm, in percent
// as printed: M = 1 and M = 2 to the digits given, M = 3 and 4 by their bounds.
TEST(Frequencies, AssumedModesConvergeAsInTheReference) {
  ArmParameters p = ThesisRig();
  p.link1_tip_inertia = Link1TipInertia::kMotor;
  const double exact[] = {6.620644715, 8.758385487, 16.67434804, 17.35428850};
  const auto error = [&](int modes, Eigen::Index i) {
    return 100.0 * (FreeMotorFrequenciesHz(ArmModel(p, {modes, modes}), 0.0)[i] / exact[i] - 1.0);
  };
  const double one[] = {2.0, 11.5, 310.0, 347.0}, one_digit[] = {0.05, 0.05, 0.5, 0.5};
  const double two[] = {0.019, 0.106, 0.490, 0.048};
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(error(1, i), one[i], 1.001 * one_digit[i]) << i;
    EXPECT_NEAR(error(2, i), two[i], 5.01e-4) << i;
    EXPECT_LT(error(3, i), 0.0115) << i;
    EXPECT_LT(error(4, i), 0.00105) << i;
  }
}

// docs/theory/plant.md 2.2: shapes for a tip mass alone have psi''(L) = 0 and cannot carry the
// moment of motor 2's inertia; those for the inertia can.
TEST(Frequencies, ShapesForATipMassAloneCarryNoMoment) {
  ArmParameters p = ThesisRig();
  p.link1_tip_inertia = Link1TipInertia::kMotor;
  ArmParameters massless = p;  // the same arm with shapes computed without I_r2
  massless.motor2_inertia_kgm2 = 0.0;
  const LinkModes shapes = Link1Modes(massless, 2), own = Link1Modes(p, 2);
  EXPECT_NEAR(shapes.mode[0].Curvature(0.8), 0.0, 1e-9);
  EXPECT_GT(std::fabs(own.mode[1].Curvature(0.8)), 1.0);
}

// Locked rotors, 0.1 kg (docs/theory/plant.md 6.2, printed to 4 digits).
TEST(Frequencies, HeldMotorsMatchTheReference) {
  const ArmModel arm(ThesisRig(), {4, 4});
  const VectorXd straight = HeldMotorFrequenciesHz(arm, 0.0);
  const VectorXd bent = HeldMotorFrequenciesHz(arm, M_PI / 2.0);
  const double expected0[] = {0.6911, 2.0632, 10.104}, expected90[] = {0.7568, 1.8329, 10.050};
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(straight[i] / expected0[i], 1.0, 1e-4);
    EXPECT_NEAR(bent[i] / expected90[i], 1.0, 1e-4);
  }
}

// Without foreshortening the model softens with speed: in docs/theory/plant.md 6.4 the linearised
// arm is unstable from th1' = 5.228 rad/s on (th2 = 0). A documented limit of the thesis's
// kinematics.
TEST(Linearize, ArmBecomesUnstableAtTheRateOfTheReference) {
  ArmParameters p = ThesisRig();
  p.damping = DampingReading::kNone;
  const ArmModel arm(p, {4, 4});
  const auto growth = [&](double rate) {
    VectorXd v = VectorXd::Zero(arm.dof());
    v[kTheta1] = v[kTheta3] = rate;
    const MatrixXd A = Linearize(arm, VectorXd::Zero(arm.dof()), v, Vector2d::Zero()).A;
    return A.eigenvalues().real().maxCoeff();
  };
  EXPECT_LT(growth(5.227), 1e-3);  // round-off of the double zero roots: 4e-5
  EXPECT_GT(growth(5.229), 1.0);   // 1.57 1/s
}

}  // namespace
}  // namespace flexarm
