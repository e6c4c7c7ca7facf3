// A payload that is lost or picked up while the arm moves: what changes, and what is conserved.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "model/simulation/arm_simulator.h"
#include "tests/model/simulation/swinging_arm.h"
#include "tests/support/no_alloc.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr ModeCount kModes{.link1 = 4, .link2 = 3};  // unequal: one link is padded

// With all effects that involve the payload: the backlash drag depends on the load inertia, and a
// hub stopped by friction gets an impulse.
ArmParameters Rig(bool foreshortening, double payload_kg) {
  ArmParameters p = ThesisRig();
  p.foreshortening = foreshortening;
  p.payload_mass_kg = payload_kg;
  p.payload_inertia_kgm2 = 3e-3;
  p.joint[0].coulomb_friction_nm = 6.0;
  p.joint[1].coulomb_friction_nm = 1.5;
  p.joint2_backlash = {
      .model = BacklashModel::kThesis, .clearance_rad = 0.02, .restitution_slope_s_per_rad = 0.05};
  return p;
}

// Its links vibrate too: the rates of their bending contribute to the lost momentum.
ArmState Swinging(const ArmModel& model) {
  ArmState x = SwingingArm(model);
  x.v[kPhi1 + 1] = 0.05;
  x.v[model.constants().phi2()] = 0.6;
  return x;
}

// @returns number of stops of a hub
int SwingOn(ArmSimulator* simulator, ArmState* x, int steps) {
  int stops = 0;
  for (int i = 0; i < steps; ++i) {
    const ArmVector before = x->v;
    simulator->Step(*x, Vector2d(2.0, -0.3), 5e-4);
    for (const int hub : {kTheta1, kTheta2}) stops += before[hub] != 0.0 && x->v[hub] == 0.0;
  }
  return stops;
}

bool SameBytes(const ArmVector& a, const ArmVector& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

bool SameBytes(const ArmState& a, const ArmState& b) {
  return SameBytes(a.q, b.q) && SameBytes(a.v, b.v) && SameBytes(a.a, b.a);
}

class PayloadChange : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Links, PayloadChange, testing::Bool(), [](const auto& shown) {
  return shown.param ? "Foreshortened" : "AsTheThesis";
});

// A point mass m at the tip has the momenta m v'dr/dq, where r and v are the tip's, by kinematics
// without any mass; the momentum of q = (th1 and th3) is that about the shoulder. Sums of a dozen
// numbers of order 1 are compared: 1e-12 is their round-off, and the quadrature of foreshortening.
// The payload's own inertia, if omitted or removed as well, changes the energy by 1e-3 of the
// mass's.
TEST_P(PayloadChange, TheLostMomentumIsThatOfAPointMassAtTheTip) {
  const double m = 0.7, left = 0.1;
  ArmModel model(Rig(GetParam(), left + m), kModes);
  const ArmState x = Swinging(model);
  const VectorXd q = x.q, v = x.v;
  const VectorXd momentum = model.MassMatrix(q) * v;
  const double energy = model.KineticEnergy(q, v), wound = model.PotentialEnergy(q);

  model.CarryPayload(left);

  EXPECT_EQ(model.parameters().payload_mass_kg, left);
  const VectorXd lost = momentum - model.MassMatrix(q) * v;
  const Vector2d tip_velocity = model.TipVelocity(q, v);
  for (int i = 0; i < model.dof(); ++i) {
    const Vector2d dr_dq = model.TipVelocity(q, VectorXd::Unit(model.dof(), i));
    EXPECT_NEAR(lost[i], m * tip_velocity.dot(dr_dq), 1e-12) << "coordinate " << i;
  }
  const Vector2d tip = model.TipPosition(q);
  EXPECT_NEAR(lost[kTheta1] + lost[kTheta3],
              m * (tip.x() * tip_velocity.y() - tip.y() * tip_velocity.x()), 1e-12);
  EXPECT_NEAR(energy - model.KineticEnergy(q, v), 0.5 * m * tip_velocity.squaredNorm(), 1e-12);
  EXPECT_EQ(model.PotentialEnergy(q), wound);
  EXPECT_GT(tip_velocity.norm(), 1.0) << "the tip is too slow for this test";
}

TEST_P(PayloadChange, TheSamePayloadChangesNothing) {
  ArmModel model(Rig(GetParam(), 0.4), kModes);
  ArmSimulator simulator(model), undisturbed(model);
  ArmState x = Swinging(model), same = x;
  SwingOn(&simulator, &x, 200);
  SwingOn(&undisturbed, &same, 200);
  model.CarryPayload(0.4);
  simulator.CarryPayloadOf(model);
  SwingOn(&simulator, &x, 200);
  SwingOn(&undisturbed, &same, 200);
  EXPECT_TRUE(SameBytes(x, same));
}

// Payload up, down and up again: no trace of the intermediate payloads is left.
TEST_P(PayloadChange, TheArmThenEqualsOneConstructedWithThatPayload) {
  ArmModel model(Rig(GetParam(), 0.1), kModes);
  ArmSimulator simulator(model);
  ArmState x = Swinging(model);
  double carried_kg = 0.1;
  int stops = 0;
  for (const double payload_kg : {1.0, 0.0, 0.3}) {
    SwingOn(&simulator, &x, 100);
    const ArmState start = x;
    model.CarryPayload(payload_kg);
    simulator.CarryPayloadOf(model);
    EXPECT_TRUE(SameBytes(x, start)) << "the state jumped";
    stops += SwingOn(&simulator, &x, 200);

    const ArmModel anew(Rig(GetParam(), payload_kg), kModes),
        before(Rig(GetParam(), carried_kg), kModes);
    ArmSimulator stepped(anew), unchanged(before);
    ArmState expected = start, other = start;
    SwingOn(&stepped, &expected, 200);
    SwingOn(&unchanged, &other, 200);
    EXPECT_TRUE(SameBytes(x, expected)) << payload_kg;
    EXPECT_GT((x.q - other.q).norm(), 1e-4) << "the payload makes no difference";
    const VectorXd q = x.q, v = x.v;
    EXPECT_EQ(model.MassMatrix(q), anew.MassMatrix(q));
    EXPECT_EQ(model.Acceleration(q, v, v), anew.Acceleration(q, v, v));
    carried_kg = payload_kg;
  }
  EXPECT_GT(stops, 0) << "no hub was stopped";
}

TEST_P(PayloadChange, DoesNotAllocate) {
  ArmModel model(Rig(GetParam(), 0.1), kModes);
  ArmSimulator simulator(model);
  ArmState x = Swinging(model);
  SwingOn(&simulator, &x, 1);
  const NoAlloc armed;
  model.CarryPayload(0.8);
  simulator.CarryPayloadOf(model);
  SwingOn(&simulator, &x, 1);
}

}  // namespace
}  // namespace flexarm
