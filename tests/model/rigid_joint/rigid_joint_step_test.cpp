// A sample of the small model and its derivatives: against another program's numbers, the off-line
// simulator, the matrix exponential and finite differences.

#include "model/rigid_joint/rigid_joint_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/arm/arm_model.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/rigid_joint/rigid_joint_transition.h"
#include "model/simulation/arm_simulator.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/golden_data.h"
#include "tests/support/loop_time.h"
#include "tests/support/no_alloc.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vector = RigidJointArm::Vector;

VectorXd Stacked(const GaugedState& x) {
  VectorXd out(16);
  out << x.q, x.v, x.phi_f;
  return out;
}

GaugedState Unstacked(const VectorXd& x) {
  return {.q = x.head<6>(), .v = x.segment<6>(6), .phi_f = x.tail<4>()};
}

MatrixXd PhiOf(const Transition& t) {
  MatrixXd Phi = MatrixXd::Zero(16, 16);
  Phi.leftCols(12) = t.by_motion;
  Phi.bottomRightCorner(4, 4).diagonal().setConstant(t.gauge_kept);
  return Phi;
}

class RigidJointSample : public testing::Test {
 protected:
  const nlohmann::json golden_ = GoldenFile("beyond-golden.json");
  const RigidJointStepper stepper_{RigidJointArm(ThesisRig()), kPeriod_s, kGauge_hz};
  const Vector q_ = AsVector(golden_["q"]), v_ = AsVector(golden_["v"]),
               a_ = AsVector(golden_["a"]);
  const double payload_kg_ = golden_["m"];
};

// 1.8e-9 measured, at joint 2 only, whose friction the other program finds by iteration.
TEST_F(RigidJointSample, AgreesWithTheGoldenStep) {
  const GaugedState start{.q = q_, .v = v_, .phi_f = 0.9 * q_.tail<4>()};
  const GaugedState end = stepper_.Advance(start, {.torque_nm = AsVector(golden_["step_u"]),
                                                   .payload_kg = payload_kg_,
                                                   .friction_nm = {0.16, 0.01}});
  EXPECT_LT(RelativeError(Stacked(end).head<12>(), AsVector(golden_["step_x"])), 1e-8);
  EXPECT_LT(RelativeError(end.phi_f, AsVector(golden_["step_xf"])), 1e-8);
}

// 2.5e-9 and 8.8e-9 measured: the error of forward differences of 1e-6.
TEST_F(RigidJointSample, TransitionAgreesWithTheGoldenMatrices) {
  const Transition t = TransitionOver(stepper_, payload_kg_, q_, v_, a_);
  EXPECT_LT(RelativeError(PhiOf(t), AsMatrix(golden_["Phi16"])), 1e-8);
  EXPECT_LT(RelativeError(t.G, AsMatrix(golden_["G16"])), 1e-8);
}

TEST_F(RigidJointSample, TheTransitionWithoutGaugesIsAPartOfTheWhole) {
  const Transition t = TransitionOver(stepper_, payload_kg_, q_, v_, a_);
  const MotionTransition motion = MotionTransitionOver(stepper_, payload_kg_, q_, v_, a_);
  EXPECT_EQ(motion.Phi, t.by_motion.topRows(12));
  EXPECT_EQ(motion.G, t.G.topLeftCorner(12, 2));
}

// The elastic arm in steps 25 times as small, with joints 100 times as stiff and unchanged rotors,
// has the same motion. Difference: torsion (1 % of the rig's), and the error of the long steps.
TEST_F(RigidJointSample, FollowsTheElasticArmWithStiffJoints) {
  ArmParameters p = ThesisRig();
  p.payload_mass_kg = payload_kg_;
  for (JointParameters& joint : p.joint) joint.stiffness_nm_per_rad *= 100.0;
  const ArmModel elastic(p, {2, 2});
  ArmSimulator simulator(elastic);
  ArmState x(elastic.dof());
  GaugedState rigid{.q = Vector::Zero(), .v = Vector::Zero(), .phi_f = Eigen::Vector4d::Zero()};
  double farthest = 0.0;
  for (int k = 0; k < 25; ++k) {
    const Eigen::Vector2d torque = k < 15 ? Eigen::Vector2d(2.0, 0.4) : Eigen::Vector2d(-2.0, -0.4);
    for (int i = 0; i < 200; ++i) simulator.Step(x, torque, 1e-4);
    rigid = stepper_.Advance(
        rigid, {.torque_nm = torque, .payload_kg = payload_kg_, .friction_nm = {0.16, 0.01}});
    EXPECT_NEAR(rigid.q[0], x.q[kTheta1], 2e-3) << k;
    EXPECT_NEAR(rigid.q[1], x.q[kTheta2], 2e-3) << k;
    EXPECT_NEAR(rigid.q[2], x.q[kPhi1], 2e-3) << k;
    EXPECT_NEAR(rigid.q[4], x.q[kPhi1 + 2], 2e-3) << k;
    farthest = std::fmax(farthest, rigid.q[0]);
  }
  EXPECT_GT(farthest, 0.05);
}

// Lanes that slide, stick, turn around and break away within the sample, each with its own payload.
TEST_F(RigidJointSample, EachOfFourCasesGetsTheBitsThatItGetsAlone) {
  const Eigen::Vector2d torque(0.3, -0.02);
  const std::array<double, 4> payload_kg = {payload_kg_, 0.0, 1.0, 0.2},
                              rate_share = {1.0, 0.0, -0.02, 0.05};
  std::array<GaugedState, 4> start;
  GaugedStateOf<Lanes> four;
  SampleInputsOf<Lanes> inputs{.torque_nm = torque, .payload_kg = {}, .friction_nm = {}};
  for (std::size_t lane = 0; lane < 4; ++lane) {
    start[lane] = {.q = q_, .v = rate_share[lane] * v_, .phi_f = 0.9 * q_.tail<4>()};
    for (int i = 0; i < RigidJointArm::kDof; ++i) {
      four.q[i].Set(lane, start[lane].q[i]);
      four.v[i].Set(lane, start[lane].v[i]);
    }
    for (int i = 0; i < 4; ++i) four.phi_f[i].Set(lane, start[lane].phi_f[i]);
    inputs.payload_kg.Set(lane, payload_kg[lane]);
    for (std::size_t hub = 0; hub < 2; ++hub) {
      inputs.friction_nm[hub].Set(lane, 0.1 * static_cast<double>(lane + hub));
    }
  }
  const GaugedStateOf<Lanes> end = stepper_.AdvanceFour(four, inputs, 8);
  for (std::size_t lane = 0; lane < 4; ++lane) {
    const GaugedState alone = stepper_.Advance(
        start[lane], {.torque_nm = torque,
                      .payload_kg = payload_kg[lane],
                      .friction_nm = {inputs.friction_nm[0][lane], inputs.friction_nm[1][lane]}});
    for (int i = 0; i < RigidJointArm::kDof; ++i) {
      EXPECT_EQ(end.q[i][lane], alone.q[i]) << lane;
      EXPECT_EQ(end.v[i][lane], alone.v[i]) << lane;
    }
    for (int i = 0; i < 4; ++i) EXPECT_EQ(end.phi_f[i][lane], alone.phi_f[i]) << lane;
  }
}

TEST_F(RigidJointSample, HubsAtRestDoNotMoveBelowBreakaway) {
  GaugedState x{.q = Vector::Zero(), .v = Vector::Zero(), .phi_f = Eigen::Vector4d::Zero()};
  for (int k = 0; k < 50; ++k) {
    x = stepper_.Advance(
        x, {.torque_nm = {0.15, -0.009}, .payload_kg = 0.1, .friction_nm = {0.16, 0.01}});
  }
  EXPECT_EQ(x.q, Vector::Zero());
}

// At rest and without friction the sample is linear: exp of the model with the gauges' filters.
// Midpoint steps of 2.5 ms rotate a mode of 18 Hz by 0.7 % too little: 1e-2 of a sample's matrix.
TEST_F(RigidJointSample, TransitionAtRestIsTheMatrixExponential) {
  const RigidJointArm& arm = stepper_.arm();
  const Vector rest = Vector::Zero();
  const auto terms = arm.At(arm.Outboard(payload_kg_), rest, rest);
  MatrixXd A = MatrixXd::Zero(16, 16), B = MatrixXd::Zero(16, 6);
  const MatrixXd inverse = terms.M.inverse();
  A.block(0, 6, 6, 6).setIdentity();
  A.block(6, 0, 6, 6) = -inverse * arm.stiffness();
  A.block(6, 6, 6, 6) = -inverse * arm.damping();
  B.middleRows(6, 6) = inverse;
  const double w_f = 2.0 * M_PI * kGauge_hz;
  A.block(12, 2, 4, 4) = w_f * MatrixXd::Identity(4, 4);
  A.block(12, 12, 4, 4) = -w_f * MatrixXd::Identity(4, 4);
  const DiscreteModel exact = ZeroOrderHold(A, B, kPeriod_s);
  const Transition t = TransitionOver(stepper_, payload_kg_, rest, rest, rest);
  EXPECT_LT(RelativeError(PhiOf(t), exact.A), 2e-2);
  EXPECT_LT(RelativeError(t.G, exact.B), 2e-2);

  // The error falls with the square of the step: a sample of 2 ms is ten times finer.
  const RigidJointStepper fine(arm, 0.1 * kPeriod_s, kGauge_hz);
  const Transition part = TransitionOver(fine, payload_kg_, rest, rest, rest);
  MatrixXd ten = MatrixXd::Identity(16, 16);
  for (int i = 0; i < 10; ++i) ten = PhiOf(part) * ten;
  EXPECT_LT(RelativeError(ten.topLeftCorner(12, 12), exact.A.topLeftCorner(12, 12)), 2e-4);
}

// Difference: one linear model of the sample's middle neglects its curvature. It falls with the
// square of the motion's size. The golden matrices contain the small terms of dg/dq and dg/dv.
TEST_F(RigidJointSample, TransitionIsTheDerivativeOfAdvance) {
  const auto advance = [&](const VectorXd& x) {
    return Stacked(stepper_.Advance(
        Unstacked(x),
        {.torque_nm = {0.25, 0.05}, .payload_kg = payload_kg_, .friction_nm = {0.0, 0.0}}));
  };
  VectorXd start(16);
  start << 0.3, -0.5, 0.01, 1e-4, 0.005, 1e-5, 0.4, -0.6, -0.06, 1e-4, -0.04, -2e-4, 0.01, 0.0, 0.0,
      0.0;
  start *= 0.25;
  const VectorXd end = advance(start);
  const VectorXd middle = 0.5 * (start + end);
  const Vector q = middle.head<6>(), v = middle.segment<6>(6),
               a = (end - start).segment<6>(6) / kPeriod_s;
  const Transition t = TransitionOver(stepper_, payload_kg_, q, v, a);
  MatrixXd differences(16, 16);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 16; ++i) {
    const VectorXd d = kStep * VectorXd::Unit(16, i);
    differences.col(i) = (advance(start + d) - advance(start - d)) / (2.0 * kStep);
  }
  EXPECT_LT(RelativeError(PhiOf(t), differences), 2e-3);
}

// Midpoint steps: half the step, a quarter of the error, in the state and in its derivatives.
TEST_F(RigidJointSample, TheErrorFallsWithTheSquareOfTheStep) {
  const auto end = [&](int steps) {
    const RigidJointStepper stepper(stepper_.arm(), kPeriod_s, kGauge_hz, steps);
    const GaugedState x = stepper.Advance(
        {.q = q_, .v = v_, .phi_f = q_.tail<4>()},
        {.torque_nm = {3.0, 0.5}, .payload_kg = payload_kg_, .friction_nm = {0.0, 0.0}});
    return VectorXd(Stacked(x).head<12>());
  };
  const auto transition = [&](int steps) {
    const RigidJointStepper stepper(stepper_.arm(), kPeriod_s, kGauge_hz, steps);
    return MatrixXd(TransitionOver(stepper, payload_kg_, q_, v_, a_).by_motion.topRows<12>());
  };
  const VectorXd exact = end(256);
  const MatrixXd exact_Phi = transition(256);
  EXPECT_NEAR(RelativeError(end(4), exact) / RelativeError(end(8), exact), 4.0, 0.5);
  EXPECT_NEAR(RelativeError(transition(4), exact_Phi) / RelativeError(transition(8), exact_Phi),
              4.0, 0.5);
}

TEST_F(RigidJointSample, DoesNotAllocate) {
  const NoAlloc armed;
  const GaugedState start{.q = q_, .v = v_, .phi_f = q_.tail<4>()};
  const GaugedState end = stepper_.Advance(
      start, {.torque_nm = {3.0, 0.5}, .payload_kg = payload_kg_, .friction_nm = {0.16, 0.01}});
  const Transition t = TransitionOver(stepper_, payload_kg_, end.q, end.v, a_);
  EXPECT_GT(t.by_motion(0, 6), 0.0);
}

}  // namespace
}  // namespace flexarm
