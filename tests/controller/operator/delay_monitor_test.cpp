#include "controller/operator/delay_monitor.h"

#include <gtest/gtest.h>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

StepInput Acted(std::int64_t acted_late_ns, std::int64_t acts_late_ns,
                SafetyState state = SafetyState::kRunning) {
  StepInput input{};
  input.acted_late_ns = acted_late_ns;
  input.acts_late_ns = acts_late_ns;
  input.safety_state = state;
  return input;
}

TEST(DelayMonitor, BeforeTheFirstStepNoDelayWasMeasured) {
  const DelayMonitor watch(20 * kMs, 0.009);
  EXPECT_EQ(watch.delay_ms(), 0.0);
  EXPECT_EQ(watch.longest_ms(), 0.0);
  EXPECT_DOUBLE_EQ(watch.margin_ms(), 9.0) << "all of it is left";
}

TEST(DelayMonitor, TellsTheDelayOfTheLastTorqueAndTheLongest) {
  DelayMonitor watch(20 * kMs, 0.009);
  watch.Take(Acted(0, 0));
  watch.Take(Acted(2 * kMs, 2 * kMs));
  watch.Take(Acted(kMs, kMs));
  EXPECT_DOUBLE_EQ(watch.delay_ms(), 21.0);
  EXPECT_DOUBLE_EQ(watch.longest_ms(), 22.0);
  EXPECT_DOUBLE_EQ(watch.margin_ms(), 7.0) << "2 ms later than predicted, then earlier";
}

// The margin counts from the delay that is predicted: a long one that was known takes none of it.
TEST(DelayMonitor, AKnownDelayTakesNothingOfTheMargin) {
  DelayMonitor watch(20 * kMs, 0.009);
  for (int k = 0; k < 5; ++k) EXPECT_FALSE(watch.Take(Acted(30 * kMs, 30 * kMs)));
  EXPECT_DOUBLE_EQ(watch.delay_ms(), 50.0);
  EXPECT_DOUBLE_EQ(watch.margin_ms(), 9.0);
}

TEST(DelayMonitor, WarnsOnceARunWhenLessThanHalfOfTheMarginIsLeft) {
  DelayMonitor watch(20 * kMs, 0.008);
  EXPECT_FALSE(watch.Take(Acted(0, 0)));
  EXPECT_FALSE(watch.Take(Acted(4 * kMs, 0))) << "just half of it";
  EXPECT_TRUE(watch.Take(Acted(4 * kMs + 1, 0)));
  EXPECT_FALSE(watch.Take(Acted(5 * kMs, 0))) << "said already";
  EXPECT_FALSE(watch.Take(Acted(5 * kMs, 0, SafetyState::kArmed)));
  EXPECT_TRUE(watch.Take(Acted(5 * kMs, 0))) << "the next run";
}

TEST(FoundDelayMonitor, TellsOnceARunThatADelayWasFound) {
  FoundDelayMonitor watch;
  const auto take = [&watch](int found, SafetyState state = SafetyState::kRunning) {
    StepOutput output{};
    output.delay_found = static_cast<std::int8_t>(found);
    return watch.Take(Acted(0, 0, state), output);
  };
  EXPECT_FALSE(take(1, SafetyState::kArmed));
  EXPECT_FALSE(take(0));
  EXPECT_TRUE(take(-1));
  EXPECT_FALSE(take(-1)) << "said already";
  EXPECT_FALSE(take(1)) << "said already";
  EXPECT_FALSE(take(1, SafetyState::kStopping));
  EXPECT_TRUE(take(1)) << "the next run";
}

TEST(FoundDelayMonitor, TellsADelayThatIsFoundInTheFirstStep) {
  FoundDelayMonitor watch;
  StepOutput output{};
  output.delay_found = 1;
  EXPECT_TRUE(watch.Take(Acted(0, 0), output));
}

TEST(DelayMonitor, SaysNothingWhileNothingRuns) {
  DelayMonitor watch(20 * kMs, 0.008);
  for (int k = 0; k < 5; ++k) EXPECT_FALSE(watch.Take(Acted(9 * kMs, 0, SafetyState::kArmed)));
}

}  // namespace
}  // namespace flexarm
