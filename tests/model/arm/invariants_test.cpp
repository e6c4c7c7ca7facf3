// Invariants of every motion of the arm: power, symmetry, limits.

#include <gtest/gtest.h>

#include <cmath>

#include "model/math/dense_decompositions.h"
#include "model/simulation/arm_simulator.h"
#include "tests/model/arm/arm_energy.h"
#include "tests/model/simulation/swinging_arm.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::VectorXd;

ArmParameters Rig(bool foreshortening) {
  ArmParameters p = ThesisRig();
  p.foreshortening = foreshortening;
  return p;
}

ArmParameters Conservative(bool foreshortening) {
  ArmParameters p = Rig(foreshortening);
  p.joint[0].coulomb_friction_nm = p.joint[1].coulomb_friction_nm = 0.0;
  p.damping = DampingReading::kNone;
  return p;
}

class Invariants : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Links, Invariants, testing::Bool(), [](const auto& shown) {
  return shown.param ? "Foreshortened" : "AsTheThesis";
});

// Energy at the end minus that at the start against the work of motors, friction and damping,
// summed at the middle of every step, with all three active. @returns the imbalance over the
// exchanged energy.
double Imbalance(bool foreshortening, double h) {
  const ArmModel model(Rig(foreshortening), {2, 2});
  ArmSimulator simulator(model, {.passes = 5});
  ArmState x = SwingingArm(model);
  const double E0 = Energy(model, x);
  double work = 0.0, turned_over = 0.0;
  // While both hubs slide: the impulse that stops a hub dissipates energy outside of the sum.
  for (int i = 0; i < static_cast<int>(std::lround(0.25 / h)); ++i) {
    const Vector2d torque(3.0, -1.0);
    const ArmState before = x;
    simulator.Step(x, torque, h);
    const VectorXd v = 0.5 * (before.v + x.v);
    const double motors = torque.dot(v.segment<2>(kTheta3));
    const double friction = 0.16 * std::fabs(v[kTheta1]) + 0.01 * std::fabs(v[kTheta2]);
    const double damping = v.dot(model.damping() * v);
    EXPECT_GT(before.v[kTheta1] * x.v[kTheta1], 0.0) << "hub 1 stopped at step " << i;
    EXPECT_GT(before.v[kTheta2] * x.v[kTheta2], 0.0) << "hub 2 stopped at step " << i;
    work += h * (motors - friction - damping);
    turned_over += h * (std::fabs(motors) + friction + damping);
  }
  return std::fabs(Energy(model, x) - E0 - work) / turned_over;
}

// Second order: a sixteenth at a quarter of the step (measured, both arms), 4e-7 at the default
// step. A friction or damping term missing in the step leaves 0.05 and more.
TEST_P(Invariants, PowerOfMotorsFrictionAndDampingBalances) {
  const double coarse = Imbalance(GetParam(), 5e-4), fine = Imbalance(GetParam(), 1.25e-4);
  EXPECT_LT(coarse, 2e-6);
  EXPECT_LT(fine, 0.12 * coarse);
}

// Without dissipation the motion is reversible: with all rates negated, the arm returns to its
// start. Midpoint is symmetric in time, so with its passes converged only round-off remains
// (1e-12 rad and 3e-11 rad/s measured).
TEST_P(Invariants, TimeCanBeReversed) {
  const ArmModel model(Conservative(GetParam()), {2, 2});
  ArmSimulator simulator(model, {.passes = 12});
  const ArmState start = SwingingArm(model);
  ArmState x = start;
  const int steps = 2000;
  const auto torque = [&](int i) { return Vector2d(i < 600 ? 1.0 : -0.5, i < 900 ? -0.2 : 0.3); };
  for (int i = 0; i < steps; ++i) simulator.Step(x, torque(i), 5e-4);
  EXPECT_GT((x.q - start.q).norm(), 0.5);
  x.v = -x.v;
  x.a.setZero();
  for (int i = steps; i-- > 0;) simulator.Step(x, torque(i), 5e-4);
  EXPECT_LT((x.q - start.q).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT((x.v + start.v).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(Invariants, MotionsDoNotDependOnTheBaseAngle) {
  const ArmModel model(Rig(GetParam()), {3, 3});
  const double turn = 1.234;
  ArmSimulator simulator(model);
  ArmState a = SwingingArm(model), b = a;
  b.q[kTheta1] += turn;
  b.q[kTheta3] += turn;
  for (int i = 0; i < 2000; ++i) simulator.Step(a, Vector2d(2.0, -0.4), 5e-4);
  for (int i = 0; i < 2000; ++i) simulator.Step(b, Vector2d(2.0, -0.4), 5e-4);
  VectorXd expected = a.q;
  expected[kTheta1] += turn;
  expected[kTheta3] += turn;
  EXPECT_LT((VectorXd(b.q) - expected).cwiseAbs().maxCoeff(), 1e-10);
}

// Textbook two-link arm of rigid bodies, torques on the links: classical Runge-Kutta.
struct RigidArm {
  double I_1, I_2, coupling;  // about shoulder with everything outboard at the elbow; about elbow

  Vector2d Acceleration(const Vector2d& q, const Vector2d& v, const Vector2d& torque) const {
    const double c = coupling * std::cos(q[1]), s = coupling * std::sin(q[1]);
    Matrix2d M;
    M << I_1 + I_2 + 2.0 * c, I_2 + c, I_2 + c, I_2;
    const Vector2d bias(-s * (2.0 * v[0] * v[1] + v[1] * v[1]), s * v[0] * v[0]);
    return M.inverse() * (torque - bias);
  }

  void Step(Vector2d* q, Vector2d* v, const Vector2d& torque, double h) const {
    const Vector2d a1 = Acceleration(*q, *v, torque), v2 = *v + 0.5 * h * a1;
    const Vector2d a2 = Acceleration(*q + 0.5 * h * *v, v2, torque), v3 = *v + 0.5 * h * a2;
    const Vector2d a3 = Acceleration(*q + 0.5 * h * v2, v3, torque), v4 = *v + h * a3;
    const Vector2d a4 = Acceleration(*q + h * v3, v4, torque);
    *q += h / 6.0 * (*v + 2.0 * v2 + 2.0 * v3 + v4);
    *v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
};

// Links and joints ten thousand times as stiff; rotors nearly massless, as the textbook has none.
// The remaining bending turns the links by 5e-6 rad (measured); a wrong rigid term changes the
// first digit.
TEST_P(Invariants, StiffArmMovesAsTheTextbookTwoLinkArm) {
  ArmParameters p = Rig(GetParam());
  p.joint[0].coulomb_friction_nm = p.joint[1].coulomb_friction_nm = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    p.link[i].section[0].youngs_modulus_pa *= 1e4;
    p.joint[i].stiffness_nm_per_rad *= 1e4;
    p.joint[i].rotor_inertia_kgm2 = 1e-9;
  }
  const double m_1 = 2707.0 * 1.575e-4 * 0.8, m_2 = 2707.0 * 9.525e-5 * 0.9, m_p = 0.1;
  const RigidArm rigid{m_1 * 0.64 / 3.0 + (3.03 + 0.24 + m_2 + m_p) * 0.64 + 1.15e-2,
                       m_2 * 0.81 / 3.0 + m_p * 0.81, (m_2 * 0.45 + m_p * 0.9) * 0.8};
  const ArmModel model(p, {2, 2});
  ArmSimulator simulator(model);
  ArmState x(model.dof());
  x.q[kTheta2] = x.q[kTheta4] = 0.5;
  Vector2d q(0.0, 0.5), v(0.0, 0.0);
  for (int i = 0; i < 4000; ++i) {  // smooth torque, so that vibrations stay small
    const double t = (i + 0.5) * 2.5e-4;
    const Vector2d torque = std::pow(std::sin(M_PI * t), 2) * Vector2d(6.0, -1.5);
    simulator.Step(x, torque, 2.5e-4);
    rigid.Step(&q, &v, torque, 2.5e-4);
  }
  EXPECT_GT(q.cwiseAbs().minCoeff(), 0.2);
  EXPECT_NEAR(x.q[kTheta1], q[0], 3e-5);
  EXPECT_NEAR(x.q[kTheta2], q[1], 3e-5);
}

}  // namespace
}  // namespace flexarm
