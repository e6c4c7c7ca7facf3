#include "model/arm/arm_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/arm/arm_equations.h"
#include "model/arm/linearization.h"
#include "model/math/dense_decompositions.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

// Two sections on link 1, a payload other than the shapes', and a large payload inertia.
ArmParameters Awkward(bool foreshortening) {
  ArmParameters p = ThesisRig();
  BeamSection root = p.link[0].section[0], end = root;
  root.length_m = 0.3;
  end.length_m = 0.5;
  root.second_moment_m4 *= 2.0;
  p.link[0].section = {root, end};
  p.payload_mass_kg = 0.35;
  p.payload_inertia_kgm2 = 2e-3;
  p.foreshortening = foreshortening;
  return p;
}

VectorXd Angles(double scale) {
  VectorXd q(9);  // modes 2 and 3
  q << 0.7, -1.1, 0.72, -1.05, 0.03, -0.002, 0.04, 0.005, -0.002;
  return scale * q;
}

VectorXd Rates() {
  VectorXd v(9);
  v << 0.8, -1.7, 0.9, -1.2, 0.3, 0.04, -0.5, 0.07, 0.03;
  return v;
}

// Parameter: with or without foreshortening.
class Arm : public testing::TestWithParam<bool> {
 protected:
  const ArmModel arm_{Awkward(GetParam()), {2, 3}};
  const VectorXd q_ = Angles(1.0), v_ = Rates();

  double SlopeRate(int link) const {  // d/dt atan of the tip slope
    const LinkModes& modes = arm_.link_modes(link);
    const Eigen::Index at = link == 1 ? 4 : 6, n = modes.count();
    const double s = modes.slope_tip.dot(q_.segment(at, n));
    return modes.slope_tip.dot(v_.segment(at, n)) / (1.0 + s * s);
  }
};

INSTANTIATE_TEST_SUITE_P(Links, Arm, testing::Bool(), [](const auto& shown) {
  return shown.param ? "Foreshortened" : "AsTheThesis";
});

// (3.19) summed over every mass point, with velocities from differentiated positions. Shares the
// positions with the model, but neither its frames nor its integrals. The central difference has an
// error of 1e-10; the smallest term, the payload's inertia, is 1e-3 of the whole.
TEST_P(Arm, KineticEnergyEqualsTheSumOverMassPoints) {
  const ArmParameters& p = arm_.parameters();
  const auto speed2 = [&](int link, double u) {
    const double h = 1e-5;
    const Vector2d d = arm_.Point(link, u, q_ + h * v_) - arm_.Point(link, u, q_ - h * v_);
    return (d / (2.0 * h)).squaredNorm();
  };
  double T = 0.0;
  for (int link = 1; link <= 2; ++link) {
    T += 0.5 * IntegrateAlong(p.link[static_cast<std::size_t>(link - 1)].section, 0.05,
                              [&](double u, const BeamSection& s) {
                                return s.mass_per_length_kg_m() * speed2(link, u);
                              });
  }
  T += 0.5 * (p.motor2_mass_kg + p.hub2_mass_kg) * speed2(1, 0.8);
  T += 0.5 * p.payload_mass_kg * speed2(2, 0.9);
  const double stator = v_[0] + SlopeRate(1), hub2 = stator + v_[1];
  T += 0.5 * p.joint[0].hub_inertia_kgm2 * v_[0] * v_[0];
  T += 0.5 * p.joint[1].hub_inertia_kgm2 * hub2 * hub2;
  T += 0.5 * p.motor2_inertia_kgm2 * stator * stator;
  T += 0.5 * p.payload_inertia_kgm2 * std::pow(hub2 + SlopeRate(2), 2);
  T += 0.5 * p.joint[0].rotor_inertia_kgm2 * v_[2] * v_[2];
  T += 0.5 * p.joint[1].rotor_inertia_kgm2 * std::pow(stator + v_[3], 2);
  EXPECT_NEAR(arm_.KineticEnergy(q_, v_) / T, 1.0, 1e-9);
  EXPECT_NEAR(0.5 * v_.dot(arm_.MassMatrix(q_) * v_) / T, 1.0, 1e-9);
}

TEST_P(Arm, PotentialEnergyEqualsTheIntegralOverTheLinks) {
  double U = 0.5 * 761.59 * std::pow(q_[2] - q_[0], 2) + 0.5 * 497.96 * std::pow(q_[3] - q_[1], 2);
  for (int link = 1; link <= 2; ++link) {
    const auto& section = arm_.parameters().link[static_cast<std::size_t>(link - 1)].section;
    U += 0.5 * IntegrateAlong(section, 0.1, [&](double u, const BeamSection& s) {
           const double curvature = arm_.Strain(link, u, q_) / s.half_thickness_m;
           return s.bending_stiffness_nm2() * curvature * curvature;
         });
  }
  EXPECT_NEAR(arm_.PotentialEnergy(q_) / U, 1.0, 1e-12);
}

TEST_P(Arm, MassMatrixIsSymmetricPositiveDefiniteAndIndependentOfTheBase) {
  const MatrixXd M = arm_.MassMatrix(q_);
  EXPECT_EQ(M, M.transpose());
  EXPECT_GT(M.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
  VectorXd turned = q_;
  turned[kTheta1] += 1.234;
  turned[kTheta3] += 1.234;
  EXPECT_LT((arm_.MassMatrix(turned) - M).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((arm_.Bias(turned, v_) - arm_.Bias(q_, v_)).cwiseAbs().maxCoeff(), 1e-12);
  const double c = std::cos(1.234), s = std::sin(1.234);
  const Vector2d tip = arm_.TipPosition(q_);
  const Vector2d expected(c * tip.x() - s * tip.y(), s * tip.x() + c * tip.y());
  EXPECT_LT((arm_.TipPosition(turned) - expected).norm(), 1e-14);
}

// Lagrange: bias = Mdot v - 1/2 grad(v'Mv). Central differences with h = 1e-5 err by 1e-9 of the
// largest entry; a missing centrifugal term by 1e-3 and more.
TEST_P(Arm, BiasFollowsFromTheMassMatrixByLagrange) {
  const double h = 1e-5;
  const MatrixXd M_dot = (arm_.MassMatrix(q_ + h * v_) - arm_.MassMatrix(q_ - h * v_)) / (2.0 * h);
  VectorXd gradient(arm_.dof());
  for (int i = 0; i < arm_.dof(); ++i) {
    // A metre of a second mode is a slope of 100: its step must be smaller by that factor.
    const double h_i = i < kPhi1 ? h : 0.01 * h;
    const VectorXd step = h_i * VectorXd::Unit(arm_.dof(), i);
    gradient[i] =
        (arm_.KineticEnergy(q_ + step, v_) - arm_.KineticEnergy(q_ - step, v_)) / (2.0 * h_i);
  }
  const VectorXd expected = M_dot * v_ - gradient, bias = arm_.Bias(q_, v_);
  EXPECT_LT((bias - expected).cwiseAbs().maxCoeff(), 1e-7 * expected.cwiseAbs().maxCoeff());
}

// dE/dt = torque work - dissipation, from the equations at one instant.
TEST_P(Arm, PowerBalances) {
  const Vector2d torque(2.0, -0.7);
  const VectorXd force = arm_.InputMatrix() * torque;
  const VectorXd a = arm_.Acceleration(q_, v_, force);
  const double h = 1e-7;  // accelerations reach 1e4
  const auto energy = [&](double t) {
    return arm_.KineticEnergy(q_ + t * v_ + 0.5 * t * t * a, v_ + t * a) +
           arm_.PotentialEnergy(q_ + t * v_ + 0.5 * t * t * a);
  };
  const double power = (energy(h) - energy(-h)) / (2.0 * h);
  const double expected = force.dot(v_) - v_.dot(arm_.damping() * v_);
  EXPECT_NEAR(power, expected, 1e-5 * std::fabs(expected));
}

TEST_P(Arm, PointVelocityIsTheDerivativeOfThePoint) {
  const double h = 1e-5;
  for (int link = 1; link <= 2; ++link) {
    const Vector2d d =
        (arm_.Point(link, 0.6, q_ + h * v_) - arm_.Point(link, 0.6, q_ - h * v_)) / (2.0 * h);
    EXPECT_LT((arm_.PointVelocity(link, 0.6, q_, v_) - d).norm(), 1e-8);
  }
}

// Sign of thesis B.2: face +1 reads +(h/2) w''. The second difference errs by 1e-8.
TEST_P(Arm, StrainIsHalfTheThicknessTimesCurvature) {
  VectorXd q = VectorXd::Zero(arm_.dof());
  q[6] = 0.01;
  const double h = 1e-4, x = 0.4;
  const auto w = [&](double u) { return arm_.Point(2, u, q).y(); };
  const double curvature = (w(x + h) - 2.0 * w(x) + w(x - h)) / (h * h);
  EXPECT_NEAR(arm_.Strain(2, x, q), 1.5875e-3 * curvature, 1e-6 * 1.5875e-3 * curvature);
  EXPECT_GT(arm_.Strain(2, x, q), 0.0);
}

// With stiff links the model is the textbook two-link arm: M11 = I1 + I2 + m2 (L1^2 + 2 L1 r c2)..
TEST(RigidLimit, MassMatrixIsTheTextbookTwoLinkArm) {
  const ArmModel arm(ThesisRig(), {1, 1});
  VectorXd q = VectorXd::Zero(6), v = VectorXd::Zero(6);
  q[kTheta2] = 0.9;
  v[kTheta1] = 1.3;
  v[kTheta2] = -0.4;
  const double m_2 = 2707.0 * 9.525e-5 * 0.9, L1 = 0.8, L2 = 0.9, m_p = 0.1;
  const double I_2 = m_2 * L2 * L2 / 3.0 + m_p * L2 * L2 + 1.05e-7 + 1.078e-7;
  const double S_2 = m_2 * L2 / 2.0 + m_p * L2, c = std::cos(0.9), s = std::sin(0.9);
  const double I_1 = 2707.0 * 1.575e-4 * std::pow(L1, 3) / 3.0 + 1.43e-7 +
                     (3.03 + 0.24 + m_2 + m_p) * L1 * L1 + 1.15e-2 + 9.25e-3;
  const MatrixXd M = arm.MassMatrix(q);
  EXPECT_NEAR(M(0, 0), I_1 + I_2 + 2.0 * S_2 * L1 * c, 1e-13);
  EXPECT_NEAR(M(0, 1), I_2 + S_2 * L1 * c, 1e-13);
  EXPECT_NEAR(M(1, 1), I_2, 1e-13);
  const VectorXd bias = arm.Bias(q, v);
  EXPECT_NEAR(bias[0], -S_2 * L1 * s * (2.0 * 1.3 * -0.4 + 0.4 * 0.4), 1e-13);
  EXPECT_NEAR(bias[1], S_2 * L1 * s * 1.3 * 1.3, 1e-13);
}

// The recursion of forces and the assembled matrix are separate code for one model: forces at unit
// acceleration must be the columns of M.
TEST_P(Arm, ForcesAtUnitAccelerationAreTheColumnsOfTheMassMatrix) {
  const MatrixXd M = arm_.MassMatrix(q_);
  for (int i = 0; i < arm_.dof(); ++i) {
    const VectorXd column = InertialForces<double>(arm_.constants(), q_, VectorXd::Zero(arm_.dof()),
                                                   VectorXd::Unit(arm_.dof(), i));
    EXPECT_LT((column - M.col(i)).cwiseAbs().maxCoeff(), 1e-13 * M.cwiseAbs().maxCoeff()) << i;
  }
}

// Shapes only span the motion: with six modes a 0.5 kg arm vibrates the same whether its shapes
// were computed for 0.5 or for 0.1 kg (3e-6 measured). Tip terms of the wrong payload err by 10 %.
TEST(ShapePayload, ArmDoesNotDependOnThePayloadOfItsShapes) {
  ArmParameters p = ThesisRig();
  p.payload_mass_kg = 0.5;
  const VectorXd foreign = FreeMotorFrequenciesHz(ArmModel(p, {6, 6}), 0.4);
  p.shape_payload_mass_kg = 0.5;
  const VectorXd own = FreeMotorFrequenciesHz(ArmModel(p, {6, 6}), 0.4);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(foreign[i] / own[i], 1.0, 1e-5) << i;
}

TEST(ArmParametersProblems, EveryViolatedRuleIsReportedAtOnce) {
  ArmParameters p = ThesisRig();
  EXPECT_TRUE(p.Problems().empty());
  p.joint[0].stiffness_nm_per_rad = 0.0;
  p.link[1].section[0].area_m2 = -1.0;
  p.payload_mass_kg = std::nan("");
  ASSERT_EQ(p.Problems().size(), 3u);
  EXPECT_EQ(p.Problems()[0].key, "link2.section[0].area_m2");
  EXPECT_EQ(p.Problems()[1].key, "joint1.stiffness_nm_per_rad");
  EXPECT_EQ(p.Problems()[2].key, "arm.payload_mass_kg");
  EXPECT_THROW(ArmModel(p, {2, 2}), std::invalid_argument);
}

// Friction acts between hub and base: link 2's base is the end of link 1, and th2 is relative to
// it, so the reaction is included. No other coordinate is damped.
TEST(ArmModel, ViscousFrictionActsOnTheHubRatesOnly) {
  for (const bool foreshortening : {false, true}) {
    ArmParameters p = Awkward(foreshortening);
    const ArmModel without(p, {2, 3});
    p.joint[0].viscous_friction_nm_s_per_rad = 2.0;
    p.joint[1].viscous_friction_nm_s_per_rad = 3.0;
    const ArmModel with(p, {2, 3});
    const VectorXd q = Angles(1.0), v = Rates(), none = VectorXd::Zero(9);
    const VectorXd lost =
        with.MassMatrix(q) * (without.Acceleration(q, v, none) - with.Acceleration(q, v, none));
    VectorXd expected = VectorXd::Zero(9);
    expected(kTheta1) = 2.0 * v(kTheta1);
    expected(kTheta2) = 3.0 * v(kTheta2);
    // Round-off of a solve with M: forces of 1e3 N cancel.
    EXPECT_LT((lost - expected).cwiseAbs().maxCoeff(), 1e-9);
  }
}

}  // namespace
}  // namespace flexarm
