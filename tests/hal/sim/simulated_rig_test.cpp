#include "hal/sim/simulated_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/hal/ideal_sim.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

constexpr SimConfig kSim = IdealSim(2, 0.5);

// Link 1 behind a gauge filter of `filter_hz`, in counts fine enough (24 bits) for its response.
SensorConfig FineGauge(double filter_hz) {
  SensorConfig sensors = ThesisSensors(0.0);
  sensors.strain_input.converter_bits = 24;
  sensors.strain_input.filter_hz = filter_hz;
  return sensors;
}

// The filter's step response 1 - exp(-t/T) cannot be isolated: its input is a moving arm. So the
// same run is filtered here by an independent recursion, the exact response to a linear input in
// every step (first-order hold): x1 = e x0 + u0 (b - e) + u1 (1 - b), b = (1 - e) T / h.
// The rig's rule uses the middle of the step: per step it errs by the curvature only, relative
// (h/T)^2 / 12 = 3e-4 of the change in a step; measured 3e-6 of the peak. A filter that used the
// step's end would be half a step late: 0.25 ms of 8 ms, 1 % and more.
TEST(SimulatedRig, GaugeFilterIsFirstOrderAtItsCorner) {
  SimulatedRig behind(ThesisRig(), FineGauge(20.0), kSim), bare(ThesisRig(), FineGauge(0.0), kSim);
  const double h = 5e-4, T = 1.0 / (2.0 * std::numbers::pi * 20.0);
  const double e = std::exp(-h / T), b = (1.0 - e) * T / h;
  double expected = 0.0, before = 0.0, worst = 0.0, peak = 0.0;
  for (int k = 0; k < 400; ++k) {
    behind.SetTorque({3.0, 0.3});
    bare.SetTorque({3.0, 0.3});
    behind.Step();
    bare.Step();
    const double input = bare.Sample(0).strain[0];
    expected = e * expected + (b - e) * before + (1.0 - b) * input;
    before = input;
    worst = std::max(worst, std::abs(behind.Sample(0).strain[0] - expected));
    peak = std::max(peak, std::abs(input));
  }
  EXPECT_GT(peak, 1e5);
  EXPECT_LT(worst, 1e-3 * peak);
}

// The lag is measured in the rotors' first half millisecond: a rotor at rest is accelerated by its
// torque alone, over its own inertia J, until its spring is twisted: (K/J)^(1/2) is 267 and
// 232 rad/s, so after that time the spring has removed (267 * 5e-4)^2 / 12 = 0.15 % of the rate.
// Rate gained: int u (1 - exp(-t/T)) dt / J; rotor 2 turns absolutely, with the end of link 1. 1 %
// allowed; a lag that differs by 10 % gives 9 %.
TEST(SimulatedRig, DriveFollowsItsSetPointWithTheElectricalLag) {
  SimConfig fine = kSim;
  fine.step_ms = 0.01;
  const ArmParameters arm = ThesisRig();
  SimulatedRig rig(arm, ThesisSensors(), fine);
  rig.SetTorque({1.0, -0.5});
  const double T = 2e-3, t = 5e-4;
  for (int k = 0; k < 50; ++k) rig.Step();
  const double impulse = t - T * (1.0 - std::exp(-t / T));
  const ArmVector& v = rig.state().v;
  const LinkModes link1 = Link1Modes(arm, fine.plant_modes);
  const double end_of_link1 =
      v(kTheta1) + link1.slope_tip(0) * v(kPhi1) + link1.slope_tip(1) * v(kPhi1 + 1);
  const double rotor1 = impulse / arm.joint[0].rotor_inertia_kgm2;
  const double rotor2 = -0.5 * impulse / arm.joint[1].rotor_inertia_kgm2;
  EXPECT_NEAR(v(kTheta3), rotor1, 0.01 * std::abs(rotor1));
  EXPECT_NEAR(v(kTheta4) + end_of_link1, rotor2, 0.01 * std::abs(rotor2));
}

TEST(SimulatedRig, WithoutLagTheTorqueActsAtOnce) {
  SimConfig direct = kSim;
  direct.step_ms = 0.01;
  direct.motor_lag_ms = {0.0, 0.0};
  const ArmParameters arm = ThesisRig();
  SimulatedRig rig(arm, ThesisSensors(), direct);
  rig.SetTorque({1.0, 0.0});
  rig.Step();
  // One step of 10 us from rest: torque * h / J, minus (267 * 1e-5)^2 / 2.
  EXPECT_NEAR(rig.state().v(kTheta3), 1e-5 / arm.joint[0].rotor_inertia_kgm2, 1e-5 * 1e-3);
}

TEST(SimulatedRig, RestsAtZeroWithEverySwitchClosed) {
  SimulatedRig rig(ThesisRig(), ThesisSensors(), kSim);
  for (int k = 0; k < 100; ++k) rig.Step();
  EXPECT_EQ(rig.levels(), kHealthyLevels);
  EXPECT_EQ(rig.truth().hub_angle_rad[0], 0.0);
  EXPECT_DOUBLE_EQ(rig.truth().tip_m[0], 0.8 + 0.9);
  EXPECT_EQ(rig.truth().tip_m[1], 0.0);
}

TEST(SimulatedRig, TheTipAgreesWithTheArmModel) {
  SimulatedRig rig(ThesisRig(), ThesisSensors(), kSim);
  for (int k = 0; k < 600; ++k) {
    rig.SetTorque({4.0, -0.6});
    rig.Step();
  }
  const ArmModel model(ThesisRig(), ModeCount{.link1 = 2, .link2 = 2});
  const Eigen::Vector2d tip = model.TipPosition(rig.state().q);
  EXPECT_GT(std::abs(rig.state().q(kPhi1)), 0.01) << "deflection too small for this test";
  EXPECT_NEAR(rig.truth().tip_m[0], tip(0), 1e-12);
  EXPECT_NEAR(rig.truth().tip_m[1], tip(1), 1e-12);
}

// A switch is a level: open beyond its angle, closed inside, one at each end of each joint.
TEST(SimulatedRig, LimitSwitchesOpenBeyondTheirAngleAndOnlyThere) {
  SimConfig near = kSim;
  near.switch_angle_deg = {2.0, 3.0};
  struct Case {
    double torque1, torque2;
    std::size_t joint;
    Line line;
  };
  for (const Case& c :
       {Case{4.0, 0.0, 0, Line::kLimit1High}, Case{-4.0, 0.0, 0, Line::kLimit1Low},
        Case{0.0, 0.4, 1, Line::kLimit2High}, Case{0.0, -0.4, 1, Line::kLimit2Low}}) {
    SimulatedRig rig(ThesisRig(), ThesisSensors(), near);
    const double limit = near.switch_angle_deg[c.joint] * std::numbers::pi / 180.0;
    bool opened = false;
    for (int k = 0; k < 1000 && !opened; ++k) {
      rig.SetTorque({c.torque1, c.torque2});
      rig.Step();
      const bool beyond = std::abs(rig.truth().hub_angle_rad[c.joint]) > limit;
      opened = (rig.levels() & LineBit(c.line)) == 0;
      EXPECT_EQ(opened, beyond);
      EXPECT_EQ(rig.Sample(0).levels, rig.levels()) << "the frame contains the levels";
    }
    EXPECT_TRUE(opened) << "the arm did not reach the switch";
  }
}

TEST(SimulatedRig, PressHoldsALineUntilItIsReleased) {
  SimulatedRig rig(ThesisRig(), ThesisSensors(), kSim);
  rig.Press(Line::kEmergencyStop, 0);
  EXPECT_EQ(rig.levels(), kHealthyLevels & ~LineBit(Line::kEmergencyStop));
  rig.Step();
  EXPECT_EQ(rig.levels(), kHealthyLevels & ~LineBit(Line::kEmergencyStop));
  rig.Press(Line::kResetButton, 1);
  rig.Press(Line::kEmergencyStop, 1);
  EXPECT_EQ(rig.levels(), kHealthyLevels | LineBit(Line::kResetButton));
  rig.Press(Line::kResetButton, 0);
  EXPECT_EQ(rig.levels(), kHealthyLevels);
}

TEST(SimulatedRig, ASwitchForcedClosedStillOpensByTheArmsOwnAngle) {
  SimConfig near = kSim;
  near.switch_angle_deg = {1.0, 95.0};
  SimulatedRig rig(ThesisRig(), ThesisSensors(), near);
  rig.Press(Line::kLimit1High, 1);
  for (int k = 0; k < 1000; ++k) {
    rig.SetTorque({4.0, 0.0});
    rig.Step();
  }
  EXPECT_EQ(rig.levels() & LineBit(Line::kLimit1High), 0u);
}

// A multiplexed rig against one that samples all channels after each of its steps of 0.5 ms:
// channel i of the first is the second's reading at 0.25 ms times i, for odd i the mean of two of
// them. Each of them is rounded to half a count, and so is the result: one count.
TEST(SimulatedRig, AMultiplexedFrameIsSampledWhileTheArmMoves) {
  SimConfig skewed = kSim;
  skewed.channel_skew_us = 250.0;
  SimulatedRig rig(ThesisRig(), FineGauge(20.0), skewed), all(ThesisRig(), FineGauge(20.0), kSim);
  for (SimulatedRig* each : {&rig, &all}) {
    each->SetTorque({3.0, -0.4});
    for (int k = 0; k < 60; ++k) each->Step();
  }
  std::vector<SensorFrame> after = {all.Sample(0)};
  rig.StartFrame(7'000'000);
  EXPECT_FALSE(rig.TakeFrame().has_value());
  std::optional<SensorFrame> frame;
  int steps = 0;
  for (; !frame; ++steps) {
    rig.Step();
    all.Step();
    after.push_back(all.Sample(0));
    frame = rig.TakeFrame();
  }
  EXPECT_EQ(steps, 10) << "the last of twenty channels is sampled 4.75 ms after the first";
  EXPECT_FALSE(rig.TakeFrame().has_value()) << "a frame can be taken once";
  EXPECT_EQ(frame->sampled_at_ns, 7'000'000);
  EXPECT_EQ(frame->counter, after[0].counter);
  double largest = 0.0, moved = 0.0;
  for (std::size_t i = 0; i < 20; ++i) {
    const double expected = 0.5 * (static_cast<double>(after[i / 2].strain[i]) +
                                   static_cast<double>(after[(i + 1) / 2].strain[i]));
    largest = std::max(largest, std::abs(expected));
    moved = std::max(moved, std::abs(expected - after[0].strain[i]));
    EXPECT_NEAR(frame->strain[i], expected, 1.0) << i;
    EXPECT_EQ(frame->strain_offset_ns[i], static_cast<std::int32_t>(250'000 * i));
  }
  EXPECT_GT(moved, 1e-2 * largest) << "the arm moves too little for this test";
  EXPECT_EQ(frame->strain_valid, 0xfffffu);
}

TEST(SimulatedRig, WithoutSkewAFrameIsCompleteAtOnceAndIdentical) {
  SimulatedRig rig(ThesisRig(), ThesisSensors(), kSim), same(ThesisRig(), ThesisSensors(), kSim);
  for (SimulatedRig* each : {&rig, &same}) {
    each->SetTorque({3.0, -0.4});
    for (int k = 0; k < 60; ++k) each->Step();
  }
  rig.StartFrame(5);
  const std::optional<SensorFrame> frame = rig.TakeFrame();
  ASSERT_TRUE(frame.has_value());
  const SensorFrame sampled = same.Sample(5);
  EXPECT_EQ(std::memcmp(&*frame, &sampled, sizeof sampled), 0);
}

}  // namespace
}  // namespace flexarm
