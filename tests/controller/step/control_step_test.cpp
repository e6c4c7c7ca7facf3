#include "controller/step/control_step.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "controller/design/design_controller.h"
#include "controller/types/trip_cause.h"
#include "model/units.h"
#include "tests/controller/step/control_step_fixture.h"

namespace flexarm {
namespace {

static_assert(noexcept(std::declval<ControlStep&>().Step(std::declval<const StepInput&>())));

bool SameBytes(const StepOutput& a, const StepOutput& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// After a reset the same inputs give the same bytes, for any inputs before.
TEST_F(ControlStepTest, AfterAResetTheSameInputsGiveTheSameBytes) {
  const std::vector<StepInput> run = ARun();
  std::vector<StepOutput> first;
  for (const StepInput& input : run) first.push_back(step_.Step(input));
  StepInput poison = AtRest(100, SafetyState::kRunning);
  poison.applied_torque_nm[0] = std::numeric_limits<double>::quiet_NaN();
  step_.Step(poison);
  for (std::size_t k = 0; k < run.size(); ++k) {
    ASSERT_TRUE(SameBytes(step_.Step(run[k]), first[k])) << "tick " << k;
  }
  ControlStep other(config_, ShippedDesign());
  for (std::size_t k = 0; k < run.size(); ++k) {
    ASSERT_TRUE(SameBytes(other.Step(run[k]), first[k])) << "tick " << k;
  }
  EXPECT_NE(first[10].torque_nm[0], 0.0);
}

TEST_F(ControlStepTest, AResetContinuesFromTheGivenCounts) {
  StepInput input = AtRest(0, SafetyState::kArmed);
  input.reset = 1;
  input.counts_before = {1000, -300, 1000, 100'000};
  input.frame.counter = {1003 & 0xFF, static_cast<std::uint32_t>(-305) & 0xFF, 1003 & 0xFF,
                         100'010 & 0xFFFF};
  const StepOutput out = step_.Step(input);
  EXPECT_EQ(out.counts, (std::array<std::int64_t, 4>{1003, -305, 1003, 100'010}));
  EXPECT_NEAR(out.x_hat[0], 1003 * 2.0 * M_PI / 2540.0, 1e-12);
}

TEST_F(ControlStepTest, TorqueIsZeroInEveryStateButRunningAndTheTwoStops) {
  for (int state = 0; state <= kSafetyStates; ++state) {
    ControlStep step(config_, ShippedDesign());
    StepOutput out{};
    for (int k = 0; k < 3; ++k) {
      StepInput input = Moving(k, static_cast<SafetyState>(state));
      input.reference_ended = 1;  // Stopping starts where the reference ended: away from the arm
      out = step.Step(input);
    }
    const bool torque = out.torque_nm[0] != 0.0 || out.torque_nm[1] != 0.0;
    EXPECT_EQ(torque, state == 3 || state == 4 || state == 6) << state;
  }
}

// The arm stands still, and the reference is 21 degrees away.
TEST_F(ControlStepTest, OnlyARunHasAFollowingError) {
  RigConfig config = config_;
  config.safety.following_error_deg = {20.0, 20.0};
  for (const auto& [mode, state] : {std::pair{LoopMode::kFollow, SafetyState::kRunning},
                                    std::pair{LoopMode::kFollow, SafetyState::kStopping},
                                    std::pair{LoopMode::kFollow, SafetyState::kArmed},
                                    std::pair{LoopMode::kRegulate, SafetyState::kRunning},
                                    std::pair{LoopMode::kOpenLoop, SafetyState::kRunning}}) {
    ControlStep step(config, ShippedDesign());
    TripCauses faults = 0;
    for (int k = 0; k < 3; ++k) {
      StepInput input = Moving(k, state);
      input.mode = mode;
      input.reference_next.x_m = {};
      input.reference_next.x_m[0] = 21.0 * kRadPerDeg;
      faults = step.Step(input).faults;
    }
    const bool follows = mode == LoopMode::kFollow && state == SafetyState::kRunning;
    EXPECT_EQ(faults, follows ? CauseBit(TripCause::kFollowingError1) : 0) << ToString(state);
  }
}

// docs/safety.md, "Stop categories". The reference of Moving would ask for another torque.
TEST_F(ControlStepTest, ACauseOfCategory1IsDampedFromItsSampleOnAndAnyOtherIsZero) {
  RigConfig config = config_;
  config.safety.soft_angle_deg = {0.1, 0.1};  // 3 counts of hub 1 are 0.43 degrees
  ControlStep running(config, ShippedDesign()), stopping(config, ShippedDesign());
  const auto at = [](int k, SafetyState state) {
    StepInput input = Moving(k, state);
    input.frame.counter[0] = input.frame.counter[2] = k < 3 ? 0 : 3;
    return input;
  };
  for (int k = 0; k < 6; ++k) {
    const StepOutput out = running.Step(at(k, SafetyState::kRunning));
    const StepOutput stop =
        stopping.Step(at(k, k < 3 ? SafetyState::kRunning : SafetyState::kFaultStopping));
    EXPECT_EQ(out.faults, k < 3 ? 0 : CauseBit(TripCause::kSoftLimit1)) << k;
    EXPECT_EQ(out.torque_nm, stop.torque_nm) << k;
    EXPECT_NE(out.torque_nm[0], 0.0) << k;
  }
  StepInput input = at(6, SafetyState::kRunning);
  input.frame.sampled_at_ns -= 100'000'000;  // a stale frame as well
  const StepOutput out = running.Step(input);
  EXPECT_NE(out.faults & CauseBit(TripCause::kStaleFrame), 0u);
  EXPECT_EQ(out.torque_nm, (std::array<double, 2>{0.0, 0.0}));
}

// docs/theory/control-law.md 6.1: y_e = K (x_m - x). At zero with a pure angle reference the rest
// is the feedforward of a resting reference, the first two columns of S21, which are zero. So u = K
// x_m except for the adaptive part, of the order of r^2 T = 1e-2 of it.
TEST_F(ControlStepTest, TorqueActsTowardsTheReference) {
  const StepOutput out = step_.Step(Moving(0));
  const Eigen::Vector2d expected = ShippedDesign().K.leftCols<2>() * Eigen::Vector2d(0.01, -0.01);
  EXPECT_NEAR(out.torque_nm[0], expected(0), 0.1 * std::abs(expected(0)));
  EXPECT_GT(out.torque_nm[0], 0.0);
}

// The goal of a stop is the arm at its hub angles with untwisted joints: at rest there the torque
// is zero. A goal without the rotors of a torsional model would give K_stop times their angle.
TEST(ControlStepOfATorsionalModel, StoppingAtRestAsksForZeroTorque) {
  const RigConfig config = ShippedRig({"controller.nominal=T16"});
  ControlStep step(config, DesignController(config));
  StepOutput out{};
  for (int k = 0; k < 3; ++k) {
    StepInput input = AtRest(k, SafetyState::kStopping);
    input.reset = k == 0 ? 1 : 0;
    input.counts_before = {127, 127, 127, 1224};  // 18 degrees on all four, exactly
    input.frame.counter = {127, 127, 127, 1224};
    out = step.Step(input);
  }
  EXPECT_EQ(out.faults, 0u);
  EXPECT_NEAR(out.x_hat[0], 0.314159, 1e-6);
  EXPECT_NEAR(out.x_hat[2], out.x_hat[0], 1e-9);
  EXPECT_NEAR(out.torque_nm[0], 0.0, 1e-6);
  EXPECT_NEAR(out.torque_nm[1], 0.0, 1e-6);
}

// The gains adapted in a first run must not cause a torque step in the second: for an arm at rest
// on its reference, away from zero, the torque is zero up to round-off of K_I (x_m - x).
TEST_F(ControlStepTest, ASecondRunStartsWithoutATorqueStep) {
  const auto at_rest_on_reference = [](int k, SafetyState state) {
    StepInput input = AtRest(k, state);
    for (std::size_t i = 0; i < 3; ++i) input.frame.counter[i] = 127;
    input.frame.counter[3] = 1224;  // 18 degrees, exact on both kinds of encoder
    const double angle_rad = 127.0 * 2.0 * M_PI / 2540.0;
    for (ReferenceSample* sample : {&input.reference_now, &input.reference_next}) {
      sample->x_m[0] = sample->x_m[1] = angle_rad;
    }
    return input;
  };
  StepInput first = at_rest_on_reference(0, SafetyState::kArmed);
  first.reset = 1;
  first.counts_before = {127, 127, 127, 1224};
  step_.Step(first);
  for (int k = 1; k < 30; ++k) {
    StepInput input = at_rest_on_reference(k, SafetyState::kRunning);
    input.reference_next.x_m[0] += 0.05;  // an error, so that the gains adapt
    step_.Step(input);
  }
  const StepOutput taught = step_.Step(at_rest_on_reference(30, SafetyState::kArmed));
  ASSERT_GT(taught.adaptive_gain_change, 1e-3) << "nothing adapted: the test is inconclusive";
  StepOutput out{};
  for (int k = 31; k < 200; ++k) out = step_.Step(at_rest_on_reference(k, SafetyState::kArmed));
  EXPECT_EQ(out.adaptive_gain_change, taught.adaptive_gain_change) << "not held while Armed";
  out = step_.Step(at_rest_on_reference(200, SafetyState::kRunning));
  EXPECT_NEAR(out.torque_nm[0], 0.0, 1e-6);
  EXPECT_NEAR(out.torque_nm[1], 0.0, 1e-6);
}

// From Running to Stopping the torque is continuous. Its difference to the regulator's torque
// decays by a fifth a sample (0.1 s at 50 Hz).
TEST_F(ControlStepTest, StoppingStartsWithoutATorqueStep) {
  StepOutput running{};
  for (int k = 0; k < 3; ++k) running = step_.Step(Moving(k));
  ASSERT_GT(running.torque_nm[0], 0.3);
  const StepOutput first = step_.Step(Moving(3, SafetyState::kStopping));
  EXPECT_NEAR(first.torque_nm[0], running.torque_nm[0], 1e-12);
  EXPECT_NEAR(first.torque_nm[1], running.torque_nm[1], 1e-12);
  StepOutput out{};
  for (int k = 4; k < 100; ++k) out = step_.Step(Moving(k, SafetyState::kStopping));
  EXPECT_LT(std::abs(out.torque_nm[0]), 0.1 * running.torque_nm[0]);
}

// The limits of the shipped rig are 30 and 6 N m: references 2 and 8 rad away saturate both joints.
TEST_F(ControlStepTest, CountsTheTimeAtTheTorqueLimits) {
  StepOutput out{};
  for (int k = 0; k < 5; ++k) {
    StepInput input = Moving(k);
    input.reference_next.x_m[0] = 2.0;
    input.reference_next.x_m[1] = 8.0;
    out = step_.Step(input);
  }
  EXPECT_NEAR(out.saturated_s[0], 0.1, 1e-12);
  EXPECT_NEAR(out.saturated_s[1], 0.1, 1e-12);
  StepInput again = Moving(5);
  again.reset = 1;
  EXPECT_EQ(step_.Step(again).saturated_s, (std::array<double, 2>{0.0, 0.0}));
}

TEST_F(ControlStepTest, ReturnsItsTickAndTheEndOfTheReference) {
  StepInput input = Moving(17);
  EXPECT_EQ(step_.Step(input).tick, 17);
  EXPECT_EQ(step_.Step(input).experiment_done, 0);
  input.reference_ended = 1;
  EXPECT_EQ(step_.Step(input).experiment_done, 1);
}

TEST_F(ControlStepTest, InOpenLoopTheTorqueIsThatOfTheReferenceForAnyReadings) {
  StepInput input = Moving(0);
  input.mode = LoopMode::kOpenLoop;
  input.reference_next.u_m_nm = {1.5, -0.25};
  EXPECT_EQ(step_.Step(input).torque_nm, (std::array<double, 2>{1.5, -0.25}));
  input.reference_next.u_m_nm = {1000.0, -1000.0};
  EXPECT_EQ(step_.Step(input).torque_nm, (std::array<double, 2>{30.0, -6.0})) << "the limits";
}

TEST_F(ControlStepTest, InOpenLoopStoppingAsksForZeroTorque) {
  StepInput input = Moving(0, SafetyState::kStopping);
  input.mode = LoopMode::kOpenLoop;
  input.reference_next.u_m_nm = {1.5, -0.25};
  EXPECT_EQ(step_.Step(input).torque_nm, (std::array<double, 2>{0.0, 0.0}));
}

TEST_F(ControlStepTest, RegulatingActsTowardsTheGoalOfTheHubs) {
  StepInput input = Moving(0);
  input.mode = LoopMode::kRegulate;
  const StepOutput out = step_.Step(input);
  EXPECT_GT(out.torque_nm[0], 0.0);
  EXPECT_LT(out.torque_nm[1], 0.0);
  EXPECT_NE(out.limits & kAdaptationHeld, 0u);
}

// Homing searches for a switch outside the soft limits, with an angle that is not calibrated yet.
TEST_F(ControlStepTest, SoftLimitsApplyInEveryModeButHoming) {
  for (const LoopMode mode : {LoopMode::kFollow, LoopMode::kOpenLoop, LoopMode::kRegulate}) {
    StepInput input = Moving(0);
    input.reset = 1;
    input.mode = mode;
    input.counts_before = {800, 0, 800, 0};  // 113 degrees
    input.frame.counter[0] = input.frame.counter[2] = 800 & 0xFF;
    const bool soft = (step_.Step(input).faults & CauseBit(TripCause::kSoftLimit1)) != 0;
    EXPECT_EQ(soft, mode != LoopMode::kRegulate) << static_cast<int>(mode);
  }
}

TEST_F(ControlStepTest, ACalibrationAppliesFromTheResetOn) {
  StepInput input = AtRest(0, SafetyState::kArmed);
  input.calibration.counter_zero = {-254, 0, 0, 0};
  EXPECT_EQ(step_.Step(input).angle_rad[0], 0.0);
  input.tick = 1;
  input.reset = 1;
  EXPECT_NEAR(step_.Step(input).angle_rad[0], 0.2 * M_PI, 1e-12) << "a tenth of 2540 counts";
}

}  // namespace
}  // namespace flexarm
