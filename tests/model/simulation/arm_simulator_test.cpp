#include "model/simulation/arm_simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/model/arm/arm_energy.h"
#include "tests/model/simulation/reference_integrator.h"
#include "tests/support/no_alloc.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

static_assert(noexcept(std::declval<ArmSimulator&>().Step(std::declval<ArmState&>(),
                                                          std::declval<const Vector2d&>(), 1e-3)));

ArmParameters Frictionless() {
  ArmParameters p = ThesisRig();
  p.joint[0].coulomb_friction_nm = p.joint[1].coulomb_friction_nm = 0.0;
  return p;
}

ArmParameters Conservative() {
  ArmParameters p = Frictionless();
  p.damping = DampingReading::kNone;
  p.link1_tip_inertia = Link1TipInertia::kMotor;  // the basis of docs/theory/plant.md 7.5
  return p;
}

// Elbow at 60 deg, rates 1 and -2 rad/s, tips bent by 10 and 20 mm (docs/theory/plant.md 7.5).
ArmState EnergyTestStart(const ArmModel& model) {
  ArmState x(model.dof());
  x.q[kTheta2] = x.q[kTheta4] = M_PI / 3.0;
  x.v[kTheta1] = x.v[kTheta3] = 1.0;
  x.v[kTheta2] = x.v[kTheta4] = -2.0;
  x.q[kPhi1] = 0.01;
  x.q[model.constants().phi2()] = 0.02;
  return x;
}

// A state of the size that occurs in the base command, with every coordinate non-zero.
ArmState BusyState(const ArmModel& model) {
  ArmState x(model.dof());
  x.q.head<4>() << 0.3, -0.4, 0.31, -0.42;
  x.v.head<4>() << 0.5, -1.0, 0.6, -1.1;
  for (int i = kPhi1; i < model.dof(); ++i) {
    const int order = i < model.constants().phi2() ? i - kPhi1 : i - model.constants().phi2();
    x.q[i] = 0.02 * std::pow(-0.15, order);
    x.v[i] = 0.2 * std::pow(-0.2, order);
  }
  return x;
}

// The structured solver against the equations in dense form: the residual of
// M a + bias + D v + K q - force at the midpoint, over the largest force. After 12 passes it is the
// round-off of (v1 - v0) / h: 8e-11 at worst. Without the payload's I_p it is 1e-6.
class AnyArm : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Links, AnyArm, testing::Bool(), [](const auto& shown) {
  return shown.param ? "Foreshortened" : "AsTheThesis";
});

TEST_P(AnyArm, StepSolvesTheMidpointEquationsForAnyModeCount) {
  for (int m1 = 1; m1 <= kMaxSteppedModes; ++m1) {
    for (int m2 = 1; m2 <= kMaxSteppedModes; ++m2) {
      ArmParameters p = Frictionless();
      p.joint[0].viscous_friction_nm_s_per_rad = 0.7;
      p.joint[1].viscous_friction_nm_s_per_rad = 0.2;
      p.payload_inertia_kgm2 = 1e-3;  // large enough to have an effect
      p.payload_mass_kg = 0.3;        // not the shapes' payload
      p.foreshortening = GetParam();
      const ArmModel model(p, {m1, m2});
      ArmSimulator simulator(model, {.passes = 12});
      const ArmState start = BusyState(model);
      ArmState end = start;
      const double h = 5e-4;
      const Vector2d torque(3.0, 0.5);
      simulator.Step(end, torque, h);
      const VectorXd a = (end.v - start.v) / h, v = 0.5 * (start.v + end.v),
                     q = 0.5 * (start.q + end.q);
      const VectorXd force = model.stiffness() * q;
      const VectorXd left = model.MassMatrix(q) * a + model.Bias(q, v) + model.damping() * v +
                            force - model.InputMatrix() * torque;
      EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-9 * force.cwiseAbs().maxCoeff())
          << m1 << " and " << m2 << " modes";
      EXPECT_LT(((end.q - start.q) / h - v).cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

// docs/theory/plant.md 7.5: E0 = 1.2124174220779 J. Midpoint conserves energy to 1.5e-6 with two
// modes and to 9e-5 with four, whose undamped 570 Hz has 3.5 steps a period (measured; second
// order in h). The bound for the default integrator is 2e-5 with two modes. A missing Coriolis term
// gives 1e-2.
TEST(ArmSimulator, ConservesEnergyForTenSecondsWithoutDissipation) {
  for (const auto& [modes, bar] : {std::pair{2, 4e-6}, std::pair{4, 4e-4}}) {
    const ArmModel model(Conservative(), {modes, modes});
    ArmSimulator simulator(model);
    ArmState x = EnergyTestStart(model);
    const double E0 = Energy(model, x);
    EXPECT_NEAR(E0, 1.2124174220779, 1e-10);
    double worst = 0.0;
    for (int i = 0; i < 20000; ++i) {
      simulator.Step(x, Vector2d::Zero(), ArmSimulator::kDefaultStep_s);
      if (i % 10 == 0) worst = std::fmax(worst, std::fabs(Energy(model, x) / E0 - 1.0));
    }
    EXPECT_LT(worst, bar) << modes << " modes";
  }
}

VectorXd ForcedRun(const ArmModel& model, double h, SimulatorOptions options) {
  ArmSimulator simulator(model, options);
  ArmState x = EnergyTestStart(model);
  const int steps = static_cast<int>(std::lround(0.2 / h));
  for (int i = 0; i < steps; ++i) simulator.Step(x, Vector2d(1.0, -0.2), h);
  return x.q;
}

// Error against the reference after 0.2 s falls by 4 when h is halved. 3.5 to 4.5 allows for the
// next term of the expansion; a first-order error anywhere gives 2.
TEST(ArmSimulator, IsOfSecondOrder) {
  const ArmModel model(Frictionless(), {2, 2});
  const ReferenceIntegrator reference(model);
  const ArmState start = EnergyTestStart(model);
  VectorXd q = start.q, v = start.v;
  for (int i = 0; i < 400; ++i) reference.Step(&q, &v, Vector2d(1.0, -0.2), 5e-4);
  const double coarse = (ForcedRun(model, 2e-4, {}) - q).head<2>().norm();
  const double fine = (ForcedRun(model, 1e-4, {}) - q).head<2>().norm();
  const double finest = (ForcedRun(model, 1e-5, {}) - q).head<2>().norm();
  EXPECT_NEAR(coarse / fine, 4.0, 0.5);
  EXPECT_LT(finest, 0.02 * fine);
}

TEST(ArmSimulator, SubstepsEqualSmallerSteps) {
  const ArmModel model(ThesisRig(), {2, 2});
  EXPECT_EQ(ForcedRun(model, 2e-4, {.substeps = 2}), ForcedRun(model, 1e-4, {}));
}

// Rotation of the base is a symmetry: p_th1 + p_th3 is constant without torque at joint 1.
// Measured: 6e-10 of its size after 2 s; a base moment missing in one equation gives 1e-3.
TEST(ArmSimulator, ConservesAngularMomentumAboutTheBase) {
  const ArmModel model(Frictionless(), {3, 3});
  ArmSimulator simulator(model);
  ArmState x = EnergyTestStart(model);
  const auto momentum = [&] {
    const VectorXd p = model.MassMatrix(x.q) * x.v;
    return p[kTheta1] + p[kTheta3];
  };
  const double before = momentum();
  for (int i = 0; i < 4000; ++i) {
    const double torque2 = i % 1000 < 500 ? 0.3 : -0.3;  // joint 2 may act: its torque is internal
    simulator.Step(x, Vector2d(0.0, torque2), ArmSimulator::kDefaultStep_s);
  }
  EXPECT_NEAR(momentum(), before, 1e-8 * std::fabs(before));
}

// The rotors accelerate against their springs, and an undamped spring reaches twice the static
// torque: 0.45 of the friction stays below it, and the hubs do not move by one bit.
TEST(ArmSimulator, HubsAtRestDoNotMoveBelowBreakaway) {
  const ArmModel model(ThesisRig(), {4, 4});
  ArmSimulator simulator(model);
  ArmState x(model.dof());
  for (int i = 0; i < 4000; ++i) {
    simulator.Step(x, Vector2d(0.45 * 0.16, -0.45 * 0.01), ArmSimulator::kDefaultStep_s);
    ASSERT_EQ(x.v[kTheta1], 0.0);
    ASSERT_EQ(x.v[kTheta2], 0.0);
  }
  EXPECT_EQ(x.q[kTheta1], 0.0);
  EXPECT_EQ(x.q[kTheta2], 0.0);
  EXPECT_GT(x.q[kTheta3], 1e-6);  // the springs are twisted
}

TEST(ArmSimulator, HubsBreakAwayAboveTheFriction) {
  const ArmModel model(ThesisRig(), {4, 4});
  for (int joint = 0; joint < 2; ++joint) {
    ArmSimulator simulator(model);
    ArmState x(model.dof());
    const double friction = joint == 0 ? 0.16 : 0.01;
    const Vector2d torque = 1.1 * friction * Vector2d::Unit(joint);
    for (int i = 0; i < 2000; ++i) simulator.Step(x, torque, ArmSimulator::kDefaultStep_s);
    EXPECT_GT(x.q[joint], 1e-4) << "joint " << joint + 1;
  }
}

// A moving arm without torque: friction may only dissipate. Largest growth in a step, measured:
// 4e-15 of the start. Without the impulse at a stopped hub, its velocity would be reversed.
TEST(ArmSimulator, FrictionNeverAddsEnergyAndStopsTheHubsExactly) {
  ArmParameters p = ThesisRig();
  p.damping = DampingReading::kNone;
  const ArmModel model(p, {2, 2});
  ArmSimulator simulator(model);
  ArmState x = EnergyTestStart(model);
  const double E0 = Energy(model, x);
  double E = E0;
  int both_stuck = 0;
  for (int i = 0; i < 40000; ++i) {
    simulator.Step(x, Vector2d::Zero(), ArmSimulator::kDefaultStep_s);
    const double next = Energy(model, x);
    ASSERT_LT(next, E + 1e-11 * E0) << "step " << i;
    E = next;
    both_stuck += x.v[kTheta1] == 0.0 && x.v[kTheta2] == 0.0 ? 1 : 0;
  }
  EXPECT_LT(E, 0.2 * E0);
  EXPECT_GT(both_stuck, 1000);
}

TEST(ArmSimulator, StepsOfTenMicrosecondsAgreeWithTheDefaultStep) {
  const ArmModel model(ThesisRig(), {4, 4});
  const auto run = [&](double h) {
    ArmSimulator simulator(model);
    ArmState x(model.dof());
    const int steps = static_cast<int>(std::lround(0.5 / h));
    for (int i = 0; i < steps; ++i) simulator.Step(x, Vector2d(6.645, 0.966), h);
    return VectorXd(x.q);
  };
  // 15 deg of motion; measured difference 0.0013 deg. The bound for a closed loop is 0.25 deg.
  EXPECT_LT((run(5e-4) - run(1e-5)).head<2>().norm(), 0.005 * M_PI / 180.0);
}

// The light hub 1 springs back from a bent link at 51 rad/s: a state of a run under injected faults
// (torture, seed 7488), in which four passes leave 16 rad/s and more passes diverge.
ArmState SpringingBack(const ArmModel& model) {
  ArmState x(model.dof());
  x.q << -0.16394, 0.15208, -0.15356, 0.15844, -0.027927, 6.2290e-4, -9.5258e-5, 8.6045e-6, 0.01,
      0.0, 0.0, 0.0;
  x.v << -50.898, 0.22136, -13.250, 2.5642, 40.416, 0.17183, -0.073227, 8.5067e-3, 0.0, 0.0, 0.0,
      0.0;
  return x;
}

TEST(ArmSimulator, StepsOfAViolentSwingAreHalvedUntilTheirPassesConverge) {
  const ArmModel model(ThesisRig(), {4, 4});
  const auto after = [&model](const SimulatorOptions& options, double h_s, double until_s) {
    ArmSimulator simulator(model, options);
    ArmState x = SpringingBack(model);
    for (int k = 0; k < std::lround(until_s / h_s); ++k) {
      simulator.Step(x, Vector2d::Zero(), h_s);
    }
    return x;
  };
  constexpr double kUntil_s = 0.02;
  const ArmState exact = after({.passes = 30}, 1e-6, kUntil_s);
  const ArmState halved = after({}, ArmSimulator::kDefaultStep_s, kUntil_s);
  EXPECT_FALSE(after({.passes = 4}, ArmSimulator::kDefaultStep_s, kUntil_s).q.allFinite());
  // The hub turns 0.025 rad in the first step; the rule is left with twice that.
  EXPECT_LT((halved.q - exact.q).norm(), 0.05);
  EXPECT_LT((halved.v - exact.v).norm(), 5.0) << "of 84 at the start";
}

TEST(ArmSimulator, StepDoesNotAllocate) {
  if (!kNoAllocWorks) GTEST_SKIP() << "the sanitizer has its own allocator";
  const ArmModel model(ThesisRig(), {4, 3});
  ArmSimulator simulator(model);
  ArmState x(model.dof());
  const NoAlloc guard;
  for (int i = 0; i < 10000; ++i) {
    const double h = i < 5000 ? 5e-4 : 1e-4;  // a change of h recomputes the cached inverses
    simulator.Step(x, i % 1000 < 500 ? Vector2d(3.0, 0.5) : Vector2d(-3.0, -0.5), h);
  }
}

TEST(ArmSimulator, RepeatedRunsAreIdentical) {
  const ArmModel model(ThesisRig(), {4, 4});
  ArmSimulator simulator(model);
  ArmState a = BusyState(model), b = a;
  for (int i = 0; i < 100; ++i) simulator.Step(a, Vector2d(1.0, 0.1), 5e-4);
  simulator.Step(a, Vector2d(1.0, 0.1), 1e-4);  // another step in between has no effect
  a = b;
  for (int i = 0; i < 100; ++i) simulator.Step(a, Vector2d(1.0, 0.1), 5e-4);
  ArmSimulator fresh(model);
  for (int i = 0; i < 100; ++i) fresh.Step(b, Vector2d(1.0, 0.1), 5e-4);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.v, b.v);
}

TEST(ArmSimulator, RejectsOptionsOutOfBounds) {
  const ArmModel model(ThesisRig(), {1, 1});
  EXPECT_THROW(ArmSimulator(model, {.passes = 0}), std::invalid_argument);
  EXPECT_THROW(ArmSimulator(model, {.substeps = 0}), std::invalid_argument);
  EXPECT_THROW(ArmModel(ThesisRig(), {0, 1}), std::invalid_argument);
  EXPECT_THROW(ArmModel(ThesisRig(), {1, kMaxModesPerLink + 1}), std::invalid_argument);
  const ArmModel fine(ThesisRig(), {2, kMaxSteppedModes + 1});
  EXPECT_THROW(ArmSimulator{fine}, std::invalid_argument);
  EXPECT_THROW(ArmState(kMaxSteppedDof + 1), std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
