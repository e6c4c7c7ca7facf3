// The model against finite elements of the same arm (fe_arm.h).

#include "tests/model/arm/fe_arm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "model/beam/link_modes.h"
#include "model/math/dense_decompositions.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr int kElements = 20;

ArmParameters RigCarrying(double payload) {
  ArmParameters p = ThesisRig();
  p.payload_mass_kg = p.shape_payload_mass_kg = payload;
  return p;
}

// Check of the reference itself: exact dynamic stiffness of the whole arm (docs/theory/plant.md
// 6.2), which 40 elements match to 4e-6.
TEST(FeArm, HasTheExactFrequenciesOfTheReference) {
  const double exact[] = {6.620644715, 8.758385487, 16.67434804, 17.35428850};
  const VectorXd fe = FeArm(RigCarrying(0.1), 0.0, kElements).FreeFrequenciesHz();
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(fe[i] / exact[i], 1.0, 4e-6) << i;
}

// Six modes a link, six frequencies of the arm, five elbow angles, four payloads. The difference is
// the error of the assumed modes, from above: 1.6e-5 at worst, measured.
TEST(FeArm, SixModesGiveTheFirstSixFrequencies) {
  for (const double degrees : {0.0, 30.0, 60.0, 90.0, 135.0}) {
    for (const double payload : {0.0, 0.1, 0.5, 1.0}) {
      const double theta2 = degrees * M_PI / 180.0;
      const VectorXd fe = FeArm(RigCarrying(payload), theta2, kElements).FreeFrequenciesHz();
      const VectorXd modes = FreeMotorFrequenciesHz(ArmModel(RigCarrying(payload), {6, 6}), theta2);
      for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(modes[i] / fe[i], 1.0, 1e-4)
            << degrees << " deg, " << payload << " kg, frequency " << i + 1;
      }
    }
  }
}

// Shapes of link 1: those for a tip mass alone have psi''(L) = 0, cannot carry the moment of motor
// 2's inertia, err by 2.9 % in f2 with two modes and converge like 1/M; those for the inertia too
// err by 0.106 % (docs/theory/plant.md 6.3, to its digits).
TEST(FeArm, ShapesForATipMassAloneConvergeSlowly) {
  const ArmParameters p = RigCarrying(0.1);
  const FeArm fe(p, 0.0, kElements);
  const double exact = fe.FreeFrequenciesHz()[1];
  const auto error_percent = [&](double tip_inertia, int modes) {
    const auto psi1 = ClampedModes(p.link[0].section, {Link1Tip(p).mass_kg, tip_inertia}, modes);
    const auto psi2 = ClampedModes(p.link[1].section, Link2Tip(p), modes);
    return 100.0 * (fe.FreeFrequenciesHz(fe.Basis(psi1, psi2))[1] / exact - 1.0);
  };
  EXPECT_NEAR(error_percent(0.0, 2), 2.9, 0.05);
  EXPECT_NEAR(error_percent(p.motor2_inertia_kgm2, 2), 0.106, 1e-3);
  EXPECT_NEAR(error_percent(0.0, 2) / error_percent(0.0, 4), 2.0, 0.4);
  EXPECT_LT(error_percent(p.motor2_inertia_kgm2, 4), 1e-3);
}

// Links with a step and with two sections of different material.
TEST(FeArm, SteppedLinksAgreeToo) {
  ArmParameters p = RigCarrying(0.2);
  BeamSection root = p.link[0].section[0], end = root;
  root.length_m = 0.15, root.second_moment_m4 *= 4.0, root.area_m2 *= 1.6;
  end.length_m = 0.65;
  p.link[0].section = {root, end};
  const VectorXd fe = FeArm(p, 0.8, kElements).FreeFrequenciesHz();
  const VectorXd modes = FreeMotorFrequenciesHz(ArmModel(p, {6, 6}), 0.8);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(modes[i] / fe[i], 1.0, 1e-4) << i;
}

// A small force at the tip, rotors held: elements are exact here, assumed modes converge from below
// (deflections that they do not contain make the arm too stiff).
TEST(FeArm, StaticDisplacementOfTheTipAgrees) {
  for (const double degrees : {0.0, 45.0, 90.0}) {
    const double theta2 = degrees * M_PI / 180.0;
    const ArmModel arm(RigCarrying(0.1), {6, 6});
    const FeArm fe(RigCarrying(0.1), theta2, kElements);
    VectorXd q = VectorXd::Zero(arm.dof());
    q[kTheta2] = q[kTheta4] = theta2;
    MatrixXd J(2, arm.dof());
    for (int i = 0; i < arm.dof(); ++i) {
      J.col(i) = arm.TipVelocity(q, VectorXd::Unit(arm.dof(), i));
    }
    Eigen::VectorXi kept(arm.dof() - 2);
    kept << 0, 1, Eigen::VectorXi::LinSpaced(arm.dof() - 4, 4, arm.dof() - 1);
    const MatrixXd J_kept = J(Eigen::all, kept), K = arm.stiffness()(kept, kept);
    for (const Vector2d& force : {Vector2d(1.0, 0.0), Vector2d(0.0, 1.0)}) {
      const Vector2d exact = fe.TipDisplacement(force);
      const Vector2d modes = J_kept * K.ldlt().solve(J_kept.transpose() * force);
      EXPECT_LT((modes - exact).norm(), 1e-4 * fe.TipDisplacement({0.0, 1.0}).norm())
          << degrees << " deg";
    }
  }
}

}  // namespace
}  // namespace flexarm
