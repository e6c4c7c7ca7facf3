#include "model/arm/backlash.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/arm/linearization.h"
#include "model/simulation/arm_simulator.h"
#include "tests/model/arm/arm_energy.h"
#include "tests/model/simulation/reference_integrator.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kPlay = 0.02;  // rad, about a degree

ArmParameters WithPlay(BacklashModel model, double clearance, double zeta) {
  ArmParameters p = ThesisRig();
  p.joint[0].coulomb_friction_nm = p.joint[1].coulomb_friction_nm = 0.0;
  p.damping = DampingReading::kNone;
  p.joint2_backlash = {model, clearance, zeta};
  return p;
}

TEST(Backlash, SpringWithBacklashHasADeadZoneOfTheWholeClearance) {
  const Backlash joint(WithPlay(BacklashModel::kDeadZone, kPlay, 0.0), 0.15);
  EXPECT_EQ(joint.At(0.0099, 3.0, 3.0).spring_nm, 0.0);
  EXPECT_EQ(joint.At(-0.0099, 3.0, 3.0).stiffness_nm_per_rad, 0.0);
  EXPECT_NEAR(joint.At(0.0110, 0.0, 0.0).spring_nm, 497.96 * 0.001, 1e-12);
  EXPECT_NEAR(joint.At(-0.0110, 0.0, 0.0).spring_nm, -497.96 * 0.001, 1e-12);
}

// Teeth cannot pull: the torque does not change its sign at any separation rate.
TEST(Backlash, ContactTorqueIsNeverAttractive) {
  const Backlash joint(WithPlay(BacklashModel::kDeadZone, kPlay, 0.3), 0.15);
  for (double rate = -20.0; rate <= 20.0; rate += 0.5) {
    EXPECT_GE(joint.At(0.013, rate, 0.0).spring_nm, 0.0) << rate;
    EXPECT_LE(joint.At(-0.013, rate, 0.0).spring_nm, 0.0) << rate;
  }
}

// A mass against one flank: m x'' = -torque. It must rebound with e = 1 - zeta v (Hunt and
// Crossley), to first order in zeta v: the next term is about (zeta v)^2.
TEST(Backlash, ImpactHasTheRestitutionOfTheThesis) {
  constexpr double kZeta = 0.2, kInertia = 0.01;
  const Backlash joint(WithPlay(BacklashModel::kDeadZone, kPlay, kZeta), 0.15);
  for (const double speed : {0.05, 0.1, 0.2}) {
    double x = 0.5 * kPlay, v = speed;
    const double h = 1e-6;
    do {  // velocity Verlet; the contact lasts 14 ms
      const double middle = v - 0.5 * h * joint.At(x, v, v).spring_nm / kInertia;
      x += h * middle;
      v = middle - 0.5 * h * joint.At(x, middle, middle).spring_nm / kInertia;
    } while (x > 0.5 * kPlay);
    EXPECT_NEAR(-v / speed, 1.0 - kZeta * speed, std::pow(kZeta * speed, 2)) << speed;
    EXPECT_LT(-v / speed, 1.0 - 0.8 * kZeta * speed) << "an impact must lose energy";
  }
}

// The slopes that the implicit step and the linearisation use.
TEST(Backlash, SlopesAreTheDerivatives) {
  for (const BacklashModel model : {BacklashModel::kDeadZone, BacklashModel::kThesis}) {
    const Backlash joint(WithPlay(model, kPlay, 0.2), 0.15);
    const double h = 1e-6;
    for (const double twist : {-0.015, 0.003, 0.012}) {
      const Joint2Torque at = joint.At(twist, 0.7, 1.3);
      const auto slope = [&](double dx, double dv, double dw) {
        const Joint2Torque up = joint.At(twist + dx, 0.7 + dv, 1.3 + dw),
                           down = joint.At(twist - dx, 0.7 - dv, 1.3 - dw);
        return Vector2d((up.spring_nm - down.spring_nm) / (2.0 * h),
                        (up.drag_nm - down.drag_nm) / (2.0 * h));
      };
      EXPECT_NEAR(slope(h, 0, 0)[0], at.stiffness_nm_per_rad, 1e-6);
      EXPECT_NEAR(slope(0, h, 0)[0], at.damping_nms_per_rad, 1e-6);
      EXPECT_NEAR(slope(0, 0, h)[1], at.drag_slope_nms, 1e-6);
    }
  }
}

// The drag is half the derivative of V_B = Delta E / (2 Delta t) as (3.9)-(3.11) define it, with
// the impact's velocities solved from momentum and restitution.
TEST(Backlash, ThesisFormIsTheDerivativeOfItsDissipation) {
  const double zeta = 0.2, I_1 = 9.25e-3, I_2 = 0.15;
  const Backlash joint(WithPlay(BacklashModel::kThesis, kPlay, zeta), I_2);
  const auto V_B = [&](double v) {
    const double e = 1.0 - zeta * v, p1 = v;  // v1 = 0 before
    const double p2 = p1 * (I_1 - e * I_2) / (I_1 + I_2), v2 = I_1 * p1 * (1.0 + e) / (I_1 + I_2);
    const double lost = 0.5 * I_1 * (p1 * p1 - p2 * p2) - 0.5 * I_2 * v2 * v2;
    const double between = 0.5 * (kPlay / p1 + kPlay / (v2 - p2));
    return 0.5 * lost / between;
  };
  for (const double v : {0.5, 1.0, 2.0, 3.9}) {
    const double h = 1e-5, expected = (V_B(v + h) - V_B(v - h)) / (2.0 * h);
    EXPECT_NEAR(joint.At(0.0, 0.0, v).drag_nm, expected, 1e-8 * std::fabs(expected) + 1e-9) << v;
    EXPECT_EQ(joint.At(0.0, 0.0, -v).drag_nm, -joint.At(0.0, 0.0, v).drag_nm);
  }
}

// Errors of the thesis's form that the header states.
TEST(Backlash, ThesisFormAddsEnergyAboveItsLimitAndDiverges) {
  const Backlash joint(WithPlay(BacklashModel::kThesis, kPlay, 0.2), 0.15);
  EXPECT_GT(joint.At(0.0, 0.0, 3.9).drag_nm, 0.0);
  EXPECT_LT(joint.At(0.0, 0.0, 4.1).drag_nm, 0.0) << "0.8 / zeta = 4 rad/s";
  const Backlash narrow(WithPlay(BacklashModel::kThesis, 1e-6 * kPlay, 0.2), 0.15);
  EXPECT_NEAR(narrow.At(0, 0, 1.0).drag_nm / joint.At(0, 0, 1.0).drag_nm, 1e6, 1.0);
}

TEST(Backlash, WithoutBacklashJointTwoIsItsSpring) {
  for (const BacklashModel model : {BacklashModel::kDeadZone, BacklashModel::kThesis}) {
    const ArmModel none(WithPlay(model, 0.0, 0.3), {2, 2});
    EXPECT_FALSE(none.constants().backlash.active());
    const Joint2Torque at = none.constants().backlash.At(0.01, 5.0, 5.0);
    EXPECT_EQ(at.spring_nm, 497.96 * 0.01);
    EXPECT_EQ(at.drag_nm, 0.0);
  }
}

// A swinging arm whose elbow gears hit both flanks.
ArmState Shaking(const ArmModel& model) {
  ArmState x(model.dof());
  x.v[kTheta4] = 2.0;
  x.v[kTheta1] = x.v[kTheta3] = 0.5;
  x.q[kPhi1] = 0.01;
  return x;
}

struct Swing {
  double lowest_nm, highest_nm, energy_ratio, largest_growth;
  int free_steps;
};

Swing SwingOf(const ArmParameters& p, double h) {
  const ArmModel model(p, {3, 3});
  ArmSimulator simulator(model);
  ArmState x = Shaking(model);
  const double E0 = Energy(model, x);
  double E = E0;
  Swing out{0, 0, 0, 0, 0};
  for (int i = 0; i < static_cast<int>(std::lround(2.0 / h)); ++i) {
    simulator.Step(x, Vector2d::Zero(), h);
    const double next = Energy(model, x);
    out.largest_growth = std::fmax(out.largest_growth, (next - E) / E0);
    E = next;
    const double torque =
        model.constants().backlash.At(x.q[kTheta4] - x.q[kTheta2], 0.0, 0.0).spring_nm;
    out.lowest_nm = std::fmin(out.lowest_nm, torque);
    out.highest_nm = std::fmax(out.highest_nm, torque);
    out.free_steps += torque == 0.0 ? 1 : 0;
  }
  out.energy_ratio = E / E0;
  return out;
}

// Both flanks are hit, the joint is free for a good part of the time, and without loss the energy
// is conserved. Midpoint errs where a flank is hit inside a step: 1e-3 in 2 s at 0.1 ms, measured.
TEST(Backlash, LosslessBacklashConservesEnergyThroughImpacts) {
  const Swing swing = SwingOf(WithPlay(BacklashModel::kDeadZone, kPlay, 0.0), 1e-4);
  EXPECT_LT(swing.lowest_nm, -0.1);
  EXPECT_GT(swing.highest_nm, 0.1);
  EXPECT_GT(swing.free_steps, 2000);
  EXPECT_NEAR(swing.energy_ratio, 1.0, 4e-3);
}

// Measured: 0.970 of the energy left after 2 s; growth in a step 2e-5, where a flank is hit in it.
TEST(Backlash, ImpactLossNeverAddsEnergy) {
  const Swing swing = SwingOf(WithPlay(BacklashModel::kDeadZone, kPlay, 0.2), 1e-4);
  EXPECT_LT(swing.energy_ratio, 0.98);
  EXPECT_LT(swing.largest_growth, 1e-4);
}

// Measured: 0.942 left; growth in a step 3e-6, the ripple of the midpoint rule at 0.5 ms.
TEST(Backlash, ThesisFormDissipatesBelowItsLimit) {
  const Swing swing = SwingOf(WithPlay(BacklashModel::kThesis, 3.5e-3, 0.2), 5e-4);
  EXPECT_LT(swing.energy_ratio, 0.95);
  EXPECT_LT(swing.largest_growth, 1e-5);
}

// The step against the equations in dense form, both models, both kernels, within the clearance and
// on a flank: residual over the largest force, which is the round-off of (v1 - v0) / h. Newton on
// joint 2 converges with the other passes.
TEST(Backlash, StepSolvesTheMidpointEquations) {
  for (const BacklashModel backlash : {BacklashModel::kDeadZone, BacklashModel::kThesis}) {
    for (const bool foreshortening : {false, true}) {
      for (const double twist : {0.002, 0.0099, -0.013}) {
        ArmParameters p = WithPlay(backlash, kPlay, 0.2);
        p.foreshortening = foreshortening;
        p.joint[0].viscous_friction_nm_s_per_rad = 0.7;
        p.joint[1].viscous_friction_nm_s_per_rad = 0.2;
        const ArmModel model(p, {3, 2});
        ArmSimulator simulator(model, {.passes = 12});
        ArmState start = Shaking(model);
        start.q[kTheta4] = twist;
        ArmState end = start;
        const double h = 5e-4;
        simulator.Step(end, Vector2d(1.0, 0.2), h);
        const VectorXd a = (end.v - start.v) / h, v = 0.5 * (start.v + end.v),
                       q = 0.5 * (start.q + end.q);
        const VectorXd spring = model.stiffness() * q;
        const VectorXd left = model.MassMatrix(q) * a + model.Bias(q, v) + model.damping() * v +
                              spring - model.BacklashForce(q, v) -
                              model.InputMatrix() * Vector2d(1.0, 0.2);
        EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-7 * spring.cwiseAbs().maxCoeff())
            << "twist " << twist << " foreshortening " << foreshortening;
      }
    }
  }
}

// Against the explicit reference of order 10 while the teeth stay in contact (no kink): second
// order, so a quarter of the error at half the step.
TEST(Backlash, SimulatorConvergesToTheReferenceOnAFlank) {
  const ArmModel model(WithPlay(BacklashModel::kDeadZone, kPlay, 0.2), {2, 2});
  ArmState start(model.dof());
  start.q[kTheta4] = 0.03;
  const Vector2d torque(0.0, 3.0);
  const ReferenceIntegrator reference(model);
  VectorXd q = start.q, v = start.v;
  for (int i = 0; i < 40; ++i) {
    reference.Step(&q, &v, torque, 2e-5);
    ASSERT_GT(q[kTheta4] - q[kTheta2], 0.5 * kPlay) << "left the flank";
  }
  const auto error = [&](double h) {
    ArmSimulator simulator(model, {.passes = 6});
    ArmState x = start;
    for (int i = 0; i < static_cast<int>(std::lround(8e-4 / h)); ++i) simulator.Step(x, torque, h);
    return (x.q - q).head<4>().norm();
  };
  EXPECT_NEAR(error(4e-6) / error(2e-6), 4.0, 0.4);
}

TEST(Backlash, LinearisedArmHasNoSpringWithinTheClearance) {
  const ArmModel model(WithPlay(BacklashModel::kDeadZone, kPlay, 0.0), {2, 2});
  const ArmModel tight(WithPlay(BacklashModel::kDeadZone, 0.0, 0.0), {2, 2});
  VectorXd q = VectorXd::Zero(8);
  const VectorXd v = VectorXd::Zero(8);
  const auto A = [&](const ArmModel& arm) { return Linearize(arm, q, v, Vector2d::Zero()).A; };
  EXPECT_EQ(A(model)(8 + kTheta4, kTheta4), 0.0);
  EXPECT_LT(A(tight)(8 + kTheta4, kTheta4), -1e4);
  q[kTheta4] = 0.012;  // on a flank the full spring acts
  EXPECT_LT((A(model) - A(tight)).cwiseAbs().maxCoeff(), 1e-9 * A(tight).cwiseAbs().maxCoeff());
}

TEST(Backlash, InvalidParametersAreReported) {
  ArmParameters p = WithPlay(BacklashModel::kDeadZone, -0.1, std::nan(""));
  ASSERT_EQ(p.Problems().size(), 2u);
  EXPECT_EQ(p.Problems()[0].key, "joint2.backlash_rad");
  EXPECT_EQ(p.Problems()[1].key, "joint2.restitution_slope_s_per_rad");
}

}  // namespace
}  // namespace flexarm
