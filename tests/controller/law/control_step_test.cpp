#include "controller/law/control_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "controller/safety/trip_cause.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

static_assert(noexcept(std::declval<ControlStep&>().Step(std::declval<const StepInput&>())));

constexpr std::int64_t kPeriodNs = 20'000'000, kPhaseNs = 10'000'000;

// The arm at rest at zero: every counter and channel reads 0.
StepInput AtRest(std::int64_t tick, SafetyState state) {
  StepInput input{};
  input.tick = tick;
  input.sampling_instant_ns = tick * kPeriodNs;
  input.now_ns = input.sampling_instant_ns + kPhaseNs;
  input.frame.sampled_at_ns = input.sampling_instant_ns;
  input.frame.counter_valid = 0b1111;
  input.frame.strain_valid = 0xFFFFF;
  input.frame.levels = kHealthyLevels;
  input.safety_state = state;
  return input;
}

// A reference half a degree away, so that there is something to ask torque for.
StepInput Moving(std::int64_t tick, SafetyState state = SafetyState::kRunning) {
  StepInput input = AtRest(tick, state);
  input.reference_now.x_m[0] = input.reference_next.x_m[0] = 0.01;
  input.reference_now.x_m[1] = input.reference_next.x_m[1] = -0.01;
  return input;
}

// Plausible inputs of a run: counts, strains and torques that change from tick to tick.
std::vector<StepInput> ARun() {
  std::vector<StepInput> inputs;
  for (int k = 0; k < 60; ++k) {
    StepInput input = Moving(k, k < 40 ? SafetyState::kRunning : SafetyState::kStopping);
    const double angle = 30.0 * std::sin(0.05 * k);  // counts
    const auto counts = static_cast<std::int32_t>(std::lround(angle));
    for (std::size_t i = 0; i < 3; ++i) {
      input.frame.counter[i] = static_cast<std::uint32_t>(counts) & 0xFFu;
    }
    input.frame.counter[3] =
        static_cast<std::uint32_t>(std::lround(angle * 24480.0 / 2540.0)) & 0xFFFFu;
    input.applied_torque_nm = {std::sin(0.3 * k), 0.1 * std::cos(0.2 * k)};
    inputs.push_back(input);
  }
  inputs.front().reset = 1;
  return inputs;
}

class ControlStepTest : public testing::Test {
 protected:
  const Config config_ = ShippedRig();
  ControlStep step_{config_, ShippedDesign()};
};

bool SameBytes(const StepOutput& a, const StepOutput& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Whatever was before: after a reset the same inputs give the same bytes.
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

TEST_F(ControlStepTest, AResetGoesOnFromTheCountsBefore) {
  StepInput input = AtRest(0, SafetyState::kArmed);
  input.reset = 1;
  input.counts_before = {1000, -300, 1000, 100'000};
  input.frame.counter = {1003 & 0xFF, static_cast<std::uint32_t>(-305) & 0xFF, 1003 & 0xFF,
                         100'010 & 0xFFFF};
  const StepOutput out = step_.Step(input);
  EXPECT_EQ(out.counts, (std::array<std::int64_t, 4>{1003, -305, 1003, 100'010}));
  EXPECT_NEAR(out.x_hat[0], 1003 * 2.0 * M_PI / 2540.0, 1e-12);
}

TEST_F(ControlStepTest, TorqueIsZeroInEveryStateButRunningAndStopping) {
  for (int state = 0; state <= 6; ++state) {
    ControlStep step(config_, ShippedDesign());
    StepOutput out{};
    for (int k = 0; k < 3; ++k) {
      StepInput input = Moving(k, static_cast<SafetyState>(state));
      input.reference_ended = 1;  // Stopping starts where the reference ended: away from the arm
      out = step.Step(input);
    }
    const bool torque = out.torque_nm[0] != 0.0 || out.torque_nm[1] != 0.0;
    EXPECT_EQ(torque, state == 3 || state == 4) << state;
  }
}

// control.md: y_e = K (x_m - x), and at zero with a pure angle reference all else is feedforward of
// a resting reference, S21's first two columns, which are zero. So u = K x_m but for the adaptive
// part, of the order of r^2 T = 1e-2 of it.
TEST_F(ControlStepTest, TorqueActsTowardsTheReference) {
  const StepOutput out = step_.Step(Moving(0));
  const Eigen::Vector2d expected = ShippedDesign().K.leftCols<2>() * Eigen::Vector2d(0.01, -0.01);
  EXPECT_NEAR(out.torque_nm[0], expected(0), 0.1 * std::abs(expected(0)));
  EXPECT_GT(out.torque_nm[0], 0.0);
}

// The torque of the last step acts in the next one: x_next = A x_hat + B u_before.
TEST_F(ControlStepTest, PredictsToTheInstantAtWhichTheTorqueActs) {
  step_.Step(Moving(0));
  const StepOutput before = step_.Step(Moving(1));
  const StepOutput out = step_.Step(Moving(2));
  const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(out.x_hat.data(), 12);
  const Eigen::VectorXd expected =
      ShippedDesign().A * x +
      ShippedDesign().B * Eigen::Vector2d(before.torque_nm[0], before.torque_nm[1]);
  const Eigen::VectorXd predicted = Eigen::Map<const Eigen::VectorXd>(out.x_next.data(), 12);
  EXPECT_LT((predicted - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(out.limits & kPredictionOff, 0u);
}

TEST_F(ControlStepTest, WithoutPredictionTheStateIsTakenAsItIsAndFlagged) {
  ControlStep step(ShippedRig({"controller.prediction=false"}), ShippedDesign());
  step.Step(Moving(0));
  const StepOutput out = step.Step(Moving(1));
  EXPECT_EQ(out.x_next, out.x_hat);
  EXPECT_NE(out.limits & kPredictionOff, 0u);
}

// One late frame is coasted over, on prediction; beyond two periods it is a fault.
TEST_F(ControlStepTest, AFrameOfAnotherTickIsIgnored) {
  step_.Step(AtRest(0, SafetyState::kRunning));
  StepInput late = AtRest(1, SafetyState::kRunning);
  late.frame.sampled_at_ns = 0;
  late.frame.counter[0] = 20;  // what it says must not matter
  const StepOutput out = step_.Step(late);
  EXPECT_EQ(out.counters_used, 0u);
  EXPECT_EQ(out.strain_used, 0u);
  EXPECT_EQ(out.counts[0], 0);
  EXPECT_EQ(out.faults, 0u);
  EXPECT_NE(out.limits & kAdaptationHeld, 0u);
  const StepOutput next = step_.Step(AtRest(2, SafetyState::kRunning));
  EXPECT_EQ(next.counters_used, 0b1111u);
  EXPECT_EQ(next.faults, 0u);
}

TEST_F(ControlStepTest, AStaleFrameIsAFaultAndTakesTheTorque) {
  StepOutput out{};
  for (int k = 0; k <= 3; ++k) {
    StepInput input = Moving(k);
    input.frame.sampled_at_ns = 0;
    out = step_.Step(input);
  }
  EXPECT_NE(out.faults & CauseBit(TripCause::kStaleFrame), 0u);
  EXPECT_NE(out.faults & CauseBit(TripCause::kNoCounterReading), 0u);
  EXPECT_EQ(out.torque_nm, (std::array<double, 2>{0.0, 0.0}));
}

TEST_F(ControlStepTest, ATorqueThatIsNotANumberIsAFaultAndTakesTheTorque) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ControlStep step(config_, ShippedDesign());
    step.Step(Moving(0));
    StepInput poisoned = Moving(1);
    poisoned.applied_torque_nm[1] = bad;
    const StepOutput out = step.Step(poisoned);
    EXPECT_NE(out.faults & CauseBit(TripCause::kStateNotFinite), 0u);
    EXPECT_EQ(out.torque_nm, (std::array<double, 2>{0.0, 0.0}));
  }
}

// A trip is left only when its cause has gone, and the step is reset only when the arm is armed
// again: so a state that went bad must mend by itself, or the daemon can never be reset.
// Clipping alone would turn a NaN into full torque: fmax and fmin pass over it.
TEST_F(ControlStepTest, AReferenceThatIsNotANumberIsAFaultAndTakesTheTorque) {
  step_.Step(AtRest(0, SafetyState::kArmed));
  StepInput input = Moving(1);
  input.reference_next.x_m[0] = std::numeric_limits<double>::quiet_NaN();
  const StepOutput output = step_.Step(input);
  EXPECT_EQ(output.faults, CauseBit(TripCause::kStateNotFinite));
  EXPECT_EQ(output.torque_nm, (std::array<double, 2>{0.0, 0.0}));
  EXPECT_EQ(step_.Step(Moving(2)).faults, 0u) << "the adaptive gains must not have taken it in";
}

TEST_F(ControlStepTest, AStateThatWasNotFiniteMendsWhenTheInputsDo) {
  step_.Step(Moving(0));
  StepInput poisoned = Moving(1);
  poisoned.applied_torque_nm[0] = std::numeric_limits<double>::quiet_NaN();
  step_.Step(poisoned);
  StepOutput out{};
  for (int k = 2; k < 40; ++k) out = step_.Step(AtRest(k, SafetyState::kTripped));
  EXPECT_EQ(out.faults, 0u);
  EXPECT_TRUE(out.at_rest);
}

TEST_F(ControlStepTest, EchoesItsTickAndTheEndOfTheReference) {
  StepInput input = Moving(17);
  EXPECT_EQ(step_.Step(input).tick, 17);
  EXPECT_EQ(step_.Step(input).experiment_done, 0);
  input.reference_ended = 1;
  EXPECT_EQ(step_.Step(input).experiment_done, 1);
}

TEST_F(ControlStepTest, InOpenLoopTheTorqueIsTheReferencesWhateverTheSensorsSay) {
  StepInput input = Moving(0);
  input.mode = LoopMode::kOpenLoop;
  input.reference_next.u_m_nm = {1.5, -0.25};
  EXPECT_EQ(step_.Step(input).torque_nm, (std::array<double, 2>{1.5, -0.25}));
  input.reference_next.u_m_nm = {1000.0, -1000.0};
  EXPECT_EQ(step_.Step(input).torque_nm, (std::array<double, 2>{30.0, -6.0})) << "the limits";
}

TEST_F(ControlStepTest, InOpenLoopStoppingAsksForNothing) {
  StepInput input = Moving(0, SafetyState::kStopping);
  input.mode = LoopMode::kOpenLoop;
  input.reference_next.u_m_nm = {1.5, -0.25};
  EXPECT_EQ(step_.Step(input).torque_nm, (std::array<double, 2>{0.0, 0.0}));
}

TEST_F(ControlStepTest, RegulatingPullsTheHubsToTheirGoal) {
  StepInput input = Moving(0);
  input.mode = LoopMode::kRegulate;
  const StepOutput out = step_.Step(input);
  EXPECT_GT(out.torque_nm[0], 0.0);
  EXPECT_LT(out.torque_nm[1], 0.0);
  EXPECT_NE(out.limits & kAdaptationHeld, 0u);
}

// Homing looks for a switch that lies outside the soft limits, with an angle that is in doubt.
TEST_F(ControlStepTest, SoftLimitsHoldInEveryModeButHoming) {
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

TEST_F(ControlStepTest, ACalibrationCountsFromTheResetOn) {
  StepInput input = AtRest(0, SafetyState::kArmed);
  input.calibration.counter_zero = {-254, 0, 0, 0};
  EXPECT_EQ(step_.Step(input).angle_rad[0], 0.0);
  input.tick = 1;
  input.reset = 1;
  EXPECT_NEAR(step_.Step(input).angle_rad[0], 0.2 * M_PI, 1e-12) << "a tenth of 2540 counts";
}

}  // namespace
}  // namespace flexarm
