// The predicted acceleration of the tip: against the equation of motion, and its derivatives
// against differences.

#include "estimator/tip_output.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/math/dense_decompositions.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Vector = RigidJointArm::Vector;

constexpr std::array<double, 2> kProbe_nm = {1.6e-3, 1e-4};

// Both hubs slide, the links are bent and vibrate.
GaugedState Swinging() {
  GaugedState x;
  x.q << 0.3, -0.7, 0.02, -0.001, 0.03, 0.002;
  x.v << 1.2, -2.0, 0.3, 0.02, -0.4, 0.05;
  x.phi_f = x.q.tail<4>();
  return x;
}

constexpr std::array<double, 2> kFriction_nm = {0.16, 0.01};

SampleInputs Inputs() {
  return {.torque_nm = {4.0, -0.8}, .payload_kg = 0.35, .friction_nm = kFriction_nm};
}

// The equation of motion at this state, friction against the motion.
double OfTheEquation(const RigidJointArm& arm, const GaugedState& x, const SampleInputs& in) {
  const RigidJointArm::Inertia at = arm.At(arm.Outboard(in.payload_kg), x.q, x.v);
  Vector force = -at.bias - arm.damping() * x.v - arm.stiffness() * x.q;
  for (int i = 0; i < 2; ++i) {
    force[i] +=
        in.torque_nm[i] - std::copysign(in.friction_nm[static_cast<std::size_t>(i)], x.v[i]);
  }
  const Vector a = at.M.inverse() * force;
  return arm.TipAcceleration(x.q, x.v, a);
}

TEST(TipOutput, IsTheAccelerationOfTheEquationOfMotion) {
  const RigidJointStepper stepper(RigidJointArm(ThesisRig()), 0.02, kGauge_hz);
  const double shown = TipOutputAt(stepper, 0.0, Swinging(), Inputs(), kProbe_nm).m_s2;
  EXPECT_NEAR(shown, OfTheEquation(stepper.arm(), Swinging(), Inputs()), 1e-9);
  EXPECT_GT(std::fabs(shown), 1.0);
}

// The lag of a 200 Hz filter: the acceleration 0.8 ms ago.
TEST(TipOutput, IsOfTheLagBeforeTheInstant) {
  const RigidJointArm arm(ThesisRig());
  const RigidJointStepper fine(arm, 8e-4, kGauge_hz, 64), loop(arm, 0.02, kGauge_hz);
  const GaugedState before = Swinging(), now = fine.Advance(before, Inputs());
  const double was = OfTheEquation(arm, before, Inputs()), is = OfTheEquation(arm, now, Inputs());
  const double shown = TipOutputAt(loop, 8e-4, now, Inputs(), kProbe_nm).m_s2;
  EXPECT_GT(std::fabs(is - was), 0.2) << "changes too slowly for this test";
  EXPECT_LT(std::fabs(shown - was), 0.2 * std::fabs(is - was));
}

// For every state, payload, friction and torque, by central differences of the whole; forward ones
// of 1e-6 (1e-3 kg, a hundredth of the friction) err by 1e-4 of the largest derivative.
TEST(TipOutput, DerivativesAgreeWithDifferencesOfTheOutput) {
  const RigidJointStepper stepper(RigidJointArm(ThesisRig()), 0.02, kGauge_hz);
  constexpr double kLag_s = 8e-4;
  const TipOutput out = TipOutputAt(stepper, kLag_s, Swinging(), Inputs(), kProbe_nm);
  const auto at = [&](const GaugedState& x, const SampleInputs& in) {
    return TipOutputAt(stepper, kLag_s, x, in, kProbe_nm).m_s2;
  };
  const auto central = [&](double step, auto&& move) {
    GaugedState x_up = Swinging(), x_down = x_up;
    SampleInputs in_up = Inputs(), in_down = in_up;
    move(step, &x_up, &in_up);
    move(-step, &x_down, &in_down);
    return (at(x_up, in_up) - at(x_down, in_down)) / (2.0 * step);
  };
  const double largest = out.by_motion.cwiseAbs().maxCoeff();
  for (int i = 0; i < 12; ++i) {
    const double slope = central(1e-5, [i](double by, GaugedState* x, SampleInputs*) {
      (i < 6 ? x->q[i] : x->v[i - 6]) += by;
    });
    EXPECT_NEAR(out.by_motion[i], slope, 2e-3 * largest * (i < 6 ? 1.0 : 0.1)) << i;
  }
  EXPECT_EQ(out.by_motion[0], 0.0) << "rotating the whole arm changes nothing";
  const double by_payload =
      central(1e-3, [](double by, GaugedState*, SampleInputs* in) { in->payload_kg += by; });
  EXPECT_NEAR(out.by_payload, by_payload, 0.02 * std::fabs(by_payload));
  EXPECT_GT(std::fabs(by_payload), 1.0);
  for (std::size_t i = 0; i < 2; ++i) {
    const double by_friction =
        central(1e-3, [i](double by, GaugedState*, SampleInputs* in) { in->friction_nm[i] += by; });
    EXPECT_NEAR(out.by_friction[i], by_friction, 0.02 * std::fabs(by_friction)) << i;
    EXPECT_NE(by_friction, 0.0);
    const double by_torque = central(1e-3, [i](double by, GaugedState*, SampleInputs* in) {
      in->torque_nm[static_cast<int>(i)] += by;
    });
    EXPECT_NEAR(out.by_torque[i], by_torque, 0.02 * std::fabs(by_torque)) << i;
    EXPECT_NE(by_torque, 0.0);
  }
}

}  // namespace
}  // namespace flexarm
