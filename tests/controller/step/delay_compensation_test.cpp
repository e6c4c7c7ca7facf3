#include "controller/step/delay_compensation.h"

#include <gtest/gtest.h>

#include "tests/controller/step/step_at_rest.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr std::int64_t kLateNs = 5'000'000;  // from the sampling instant to the torque's effect

// Step k asks for k N m on joint 1; each acts 5 ms after (k+1) Ts. The drive reports the mean.
class DelayCompensationTest : public testing::Test {
 protected:
  StepInput InputAt(std::int64_t tick, double applied_nm) const {
    StepInput input = AtRest(tick, SafetyState::kRunning);
    input.acted_late_ns = input.acts_late_ns = kLateNs;
    input.applied_torque_nm = {applied_nm, 0.0};
    return input;
  }

  // Up to the step of `tick`, after its TakeReport and before its Push.
  StepInput RunTo(std::int64_t tick) {
    for (std::int64_t k = 0;; ++k) {
      // Over [k-1, k] Ts torque k-2 acted from 5 ms on, torque k-3 before.
      const double mean_nm = 0.25 * Asked(k - 3) + 0.75 * Asked(k - 2);
      const StepInput input = InputAt(k, mean_nm);
      delay_.TakeReport(input);
      if (k == tick) return input;
      delay_.Push(input, {Asked(k), 0.0});
    }
  }

  static double Asked(std::int64_t k) { return k < 0 ? 0.0 : static_cast<double>(k); }

  DelayCompensation delay_{kPeriodNs, false};
};

TEST_F(DelayCompensationTest, TheAppliedTorqueChangesAtTheInstantOfTheCommand) {
  const StepInput input = RunTo(10);
  const PiecewiseTorque applied = delay_.Applied(input, 0);
  ASSERT_EQ(applied.all().size(), 2U);
  EXPECT_DOUBLE_EQ(applied.all()[0].torque_nm[0], 7.0);
  EXPECT_DOUBLE_EQ(applied.all()[1].torque_nm[0], 8.0);
  EXPECT_DOUBLE_EQ(static_cast<double>(applied.all()[0].ticks) / kPeriodTicks, 0.25);
}

// The torque of this step acts 25 ms after its sample.
TEST_F(DelayCompensationTest, PendingEndsWhenTheTorqueOfThisStepActs) {
  const StepInput input = RunTo(10);
  const PiecewiseTorque pending = delay_.Pending(input, 0);
  std::int64_t ticks = 0;
  for (const TorquePiece& piece : pending.all()) ticks += piece.ticks;
  EXPECT_DOUBLE_EQ(static_cast<double>(ticks) / kPeriodTicks, 1.25);
  EXPECT_DOUBLE_EQ(pending.all().front().torque_nm[0], 8.0);
  EXPECT_DOUBLE_EQ(pending.all().back().torque_nm[0], 9.0);
}

TEST_F(DelayCompensationTest, OneMoreSampleOfDelayGivesTheTorquesOneSampleEarlier) {
  const StepInput input = RunTo(10);
  const PiecewiseTorque applied = delay_.Applied(input, 1);
  EXPECT_DOUBLE_EQ(applied.all()[0].torque_nm[0], 6.0);
  EXPECT_DOUBLE_EQ(applied.all()[1].torque_nm[0], 7.0);
  const PiecewiseTorque pending = delay_.Pending(input, 1);
  EXPECT_DOUBLE_EQ(pending.all().front().torque_nm[0], 7.0);
}

// The drive applied less than was asked, as with its slew limit.
TEST_F(DelayCompensationTest, UsesTheMeanThatTheDriveReports) {
  RunTo(9);
  delay_.Push(InputAt(9, 0.0), {9.0, 0.0});
  const StepInput input = InputAt(10, 5.0);
  delay_.TakeReport(input);
  EXPECT_NEAR(delay_.Applied(input, 0).mean_nm()[0], 5.0, 1e-12);
}

TEST_F(DelayCompensationTest, LessDelayIsAHypothesisOnlyIfAPeriodIsDeclared) {
  const StepInput input = RunTo(10);
  EXPECT_FALSE(delay_.AppliedByDelay(input)[0].has_value());
  EXPECT_TRUE(DelayCompensation(kPeriodNs, true).AppliedByDelay(input)[0].has_value());
}

TEST_F(DelayCompensationTest, AResetClearsTorquesAndReports) {
  const StepInput input = RunTo(10);
  delay_.Reset();
  EXPECT_EQ(delay_.Applied(input, 0).mean_nm(), (std::array<double, 2>{0.0, 0.0}));
  EXPECT_EQ(delay_.Pending(input, 0).mean_nm(), (std::array<double, 2>{0.0, 0.0}));
}

}  // namespace
}  // namespace flexarm
