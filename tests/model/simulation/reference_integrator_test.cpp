#include "tests/model/simulation/reference_integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "model/arm/linearization.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

ArmParameters Conservative() {
  ArmParameters p = ThesisRig();
  p.damping = DampingReading::kNone;
  p.link1_tip_inertia = Link1TipInertia::kMotor;
  return p;
}

struct Motion {
  VectorXd q, v;
};

Motion EnergyTestStart(int modes) {
  Motion x{VectorXd::Zero(4 + 2 * modes), VectorXd::Zero(4 + 2 * modes)};
  x.q[kTheta2] = x.q[kTheta4] = M_PI / 3.0;
  x.v[kTheta1] = x.v[kTheta3] = 1.0;
  x.v[kTheta2] = x.v[kTheta4] = -2.0;
  x.q[kPhi1] = 0.01;
  x.q[kPhi1 + modes] = 0.02;
  return x;
}

VectorXd After(const ArmModel& arm, int columns, double h) {
  const ReferenceIntegrator integrator(arm, columns);
  Motion x = EnergyTestStart(arm.mode_count().link1);
  const int steps = static_cast<int>(std::lround(0.048 / h));
  for (int i = 0; i < steps; ++i) integrator.Step(&x.q, &x.v, Vector2d(0.5, 0.1), h);
  return x.q;
}

// Halving h divides the error by 2^order or, in an oscillation, slightly more. One wrong weight of
// the extrapolation reduces the order to 2.
TEST(ReferenceIntegrator, ErrorFallsWithItsOrder) {
  const ArmModel arm(Conservative(), {2, 2});
  const VectorXd truth = After(arm, 7, 2e-4);
  for (const int columns : {2, 3, 4}) {
    const double coarse = (After(arm, columns, 4e-4) - truth).norm();
    const double fine = (After(arm, columns, 2e-4) - truth).norm();
    EXPECT_GT(std::log2(coarse / fine), 2 * columns - 0.5) << columns << " columns";
  }
}

struct Drift {
  int modes, columns;
  double h;
};

class EnergyDrift : public testing::TestWithParam<Drift> {};

INSTANTIATE_TEST_SUITE_P(Modes, EnergyDrift,
                         testing::Values(Drift{.modes = 2, .columns = 5, .h = 5e-4},
                                         Drift{.modes = 4, .columns = 6, .h = 2.5e-4}),
                         [](const auto& shown) { return std::to_string(shown.param.modes); });

// docs/theory/plant.md 7.5: an 8th-order integrator conserves E0 = 1.2124174220779 J to 8e-13 over
// 10 s. This one conserves it to 2e-10 (two modes) and 3e-10 (four, whose fastest has three times
// the frequency), below the bound of 1e-9, which any error in the equations' energy exceeds. Shapes
// of modes 3 and 4 start at rest, so E0 is the same.
TEST_P(EnergyDrift, StaysBelowOneInABillionForTenSeconds) {
  const auto [modes, columns, h] = GetParam();
  const ArmModel arm(Conservative(), {modes, modes});
  const ReferenceIntegrator integrator(arm, columns);
  Motion x = EnergyTestStart(modes);
  const auto energy = [&] { return arm.KineticEnergy(x.q, x.v) + arm.PotentialEnergy(x.q); };
  const double E0 = energy();
  EXPECT_NEAR(E0, 1.2124174220779, 1e-12);
  double worst = 0.0;
  for (int i = 0; i < static_cast<int>(std::lround(10.0 / h)); ++i) {
    integrator.Step(&x.q, &x.v, Vector2d::Zero(), h);
    if (i % 100 == 99) worst = std::fmax(worst, std::fabs(energy() / E0 - 1.0));
  }
  EXPECT_LT(worst, 1e-9);
}

// docs/theory/plant.md 7.1: the fastest undamped frequencies, 1207 rad/s at M = 2 and 3584 at M =
// 4, to their digits.
TEST(ReferenceIntegrator, FastestFrequenciesAgreeWithTheReference) {
  for (const auto& [modes, expected] : {std::pair{2, 1207.0}, std::pair{4, 3584.0}}) {
    const VectorXd hz =
        FreeMotorFrequenciesHz(ArmModel(Conservative(), {modes, modes}), M_PI / 3.0);
    EXPECT_NEAR(2.0 * M_PI * hz[hz.size() - 1], expected, 0.51) << modes;
  }
}

// docs/theory/plant.md 7.5: classical Runge-Kutta at 0.25 ms conserves the energy to 4e-5 over the
// same 10 s.
TEST(ReferenceIntegrator, RungeKuttaDriftsAsInTheReference) {
  const ArmModel arm(Conservative(), {2, 2});
  Motion x = EnergyTestStart(2);
  const VectorXd none = VectorXd::Zero(arm.dof());
  const auto energy = [&] { return arm.KineticEnergy(x.q, x.v) + arm.PotentialEnergy(x.q); };
  const auto rate = [&](const VectorXd& q, const VectorXd& v) {
    return arm.Acceleration(q, v, none);
  };
  const double E0 = energy(), h = 2.5e-4;
  double worst = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const VectorXd a1 = rate(x.q, x.v), v2 = x.v + 0.5 * h * a1;
    const VectorXd a2 = rate(x.q + 0.5 * h * x.v, v2), v3 = x.v + 0.5 * h * a2;
    const VectorXd a3 = rate(x.q + 0.5 * h * v2, v3), v4 = x.v + h * a3;
    const VectorXd a4 = rate(x.q + h * v3, v4);
    x.q += h / 6.0 * (x.v + 2.0 * v2 + 2.0 * v3 + v4);
    x.v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    if (i % 100 == 99) worst = std::fmax(worst, std::fabs(energy() / E0 - 1.0));
  }
  EXPECT_NEAR(worst, 4e-5, 0.5e-5);
}

struct Chapter4 {
  Vector2d tip;
  double peak_w1, peak_w2;
};

// Chapter 4: square wave of 1 s period, 1 s long, +-0.4 and +-0.1 N m, from rest, no dissipation.
Chapter4 SquareWave(int modes, double h) {
  const ArmModel arm(Conservative(), {modes, modes});
  const ReferenceIntegrator integrator(arm);
  VectorXd q = VectorXd::Zero(arm.dof()), v = q;
  Chapter4 out{Vector2d::Zero(), 0.0, 0.0};
  const int steps = static_cast<int>(std::lround(3.0 / h));
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) * h, sign = t < 0.5 ? 1.0 : t < 1.0 ? -1.0 : 0.0;
    integrator.Step(&q, &v, sign * Vector2d(0.4, 0.1), h);
    if ((i + 1) % static_cast<int>(std::lround(0.01 / h)) != 0) continue;
    out.peak_w1 = std::fmax(out.peak_w1, std::fabs(q.segment(kPhi1, modes).sum()));
    out.peak_w2 = std::fmax(out.peak_w2, std::fabs(q.tail(modes).sum()));
  }
  out.tip = arm.TipPosition(q);
  return out;
}

// Tip at 3 s and peak deflections from docs/theory/plant.md 7.5, printed to 1e-9 m and 0.01 mm. Its
// peaks are those of samples 10 ms apart: between two of them link 2 reaches 15.06 mm.
TEST(ReferenceIntegrator, Chapter4SquareWaveMatchesTheReferenceWithTwoModes) {
  const Chapter4 two = SquareWave(2, 5e-4);
  EXPECT_NEAR(two.tip.x(), 1.690807100, 2e-9);
  EXPECT_NEAR(two.tip.y(), 0.145161223, 2e-9);
  EXPECT_NEAR(two.peak_w1, 18.56e-3, 1e-5);
  EXPECT_NEAR(two.peak_w2, 14.81e-3, 1e-5);
}

TEST(ReferenceIntegrator, Chapter4SquareWaveMatchesTheReferenceWithFourModes) {
  const Chapter4 four = SquareWave(4, 2.5e-4);
  EXPECT_NEAR(four.tip.x(), 1.690798637, 2e-9);
  EXPECT_NEAR(four.tip.y(), 0.145217013, 2e-9);
}

}  // namespace
}  // namespace flexarm
