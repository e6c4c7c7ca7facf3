#include "model/reference_integrator.h"

#include <gtest/gtest.h>

#include <cmath>

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

// Halving h divides the error by 2^order or, in an oscillation, a little more. One wrong weight of
// the extrapolation drops the order to 2.
TEST(ReferenceIntegrator, ErrorFallsWithItsOrder) {
  const ArmModel arm(Conservative(), {2, 2});
  const VectorXd truth = After(arm, 7, 2e-4);
  for (const int columns : {2, 3, 4}) {
    const double coarse = (After(arm, columns, 4e-4) - truth).norm();
    const double fine = (After(arm, columns, 2e-4) - truth).norm();
    EXPECT_GT(std::log2(coarse / fine), 2 * columns - 0.5) << columns << " columns";
  }
}

// plant.md: an 8th-order integrator keeps E0 = 1.2124174220779 J to 8e-13 over 10 s. With
// h = 0.5 ms ours keeps it to the bar of 1e-9, which a slip in the equations' energy breaks at
// once.
TEST(ReferenceIntegrator, KeepsEnergyForTenSeconds) {
  const ArmModel arm(Conservative(), {2, 2});
  const ReferenceIntegrator integrator(arm);
  Motion x = EnergyTestStart(2);
  const auto energy = [&] { return arm.KineticEnergy(x.q, x.v) + arm.PotentialEnergy(x.q); };
  const double E0 = energy();
  EXPECT_NEAR(E0, 1.2124174220779, 1e-12);
  double worst = 0.0;
  for (int i = 0; i < 20000; ++i) {
    integrator.Step(&x.q, &x.v, Vector2d::Zero(), 5e-4);
    if (i % 100 == 99) worst = std::fmax(worst, std::fabs(energy() / E0 - 1.0));
  }
  EXPECT_LT(worst, 1e-9);
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

// Tip at 3 s and peak deflections from plant.md, printed to 1e-9 m and 0.01 mm. Its peaks are those
// of samples 10 ms apart: link 2 really reaches 15.06 mm between two of them.
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
