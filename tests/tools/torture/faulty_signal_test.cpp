// Each kind of fault on a ramp, whose value at every sample is known.

#include "tools/torture/faulty_signal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace flexarm {
namespace {

constexpr double kSpan = 1000.0, kPeriod_s = 0.02;

// The ramp 0, 1, 2, .. with the fault from sample 5 on; what comes out from there.
std::vector<FaultySignal::Value> Ramp(FaultKind kind, int samples, std::uint64_t seed = 1) {
  FaultySignal signal(kind, kSpan, kPeriod_s, seed);
  for (int k = 0; k < 5; ++k) signal.See(k);
  std::vector<FaultySignal::Value> out;
  for (int k = 5; k < 5 + samples; ++k) out.push_back(signal.Next(k));
  return out;
}

TEST(FaultySignal, NothingComesWhenItIsOff) {
  for (const FaultKind kind : {FaultKind::kOff, FaultKind::kNotANumber}) {
    for (const FaultySignal::Value& value : Ramp(kind, 10)) EXPECT_FALSE(value.is_valid);
  }
}

TEST(FaultySignal, AStuckOneRepeatsTheLastValueBeforeTheFault) {
  for (const FaultySignal::Value& value : Ramp(FaultKind::kStuck, 10)) {
    EXPECT_TRUE(value.is_valid);
    EXPECT_EQ(value.value, 4.0);
  }
}

TEST(FaultySignal, ALateOneIsOnePeriodOldAndSaysSoADelayedOneIsThreeAndDoesNot) {
  const auto late = Ramp(FaultKind::kLate, 10), delayed = Ramp(FaultKind::kDelayed, 10);
  for (int i = 0; i < 10; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_EQ(late[k].value, i + 4.0);
    EXPECT_TRUE(late[k].is_old);
    EXPECT_EQ(delayed[k].value, i + 2.0);
    EXPECT_FALSE(delayed[k].is_old);
  }
}

TEST(FaultySignal, TheScaleIsTwiceHalfOrTheNegative) {
  bool twice = false, half = false, negative = false;
  for (std::uint64_t seed = 1; seed < 50; ++seed) {
    const double value = Ramp(FaultKind::kWrongScale, 1, seed)[0].value;
    twice = twice || value == 10.0;
    half = half || value == 2.5;
    negative = negative || value == -5.0;
    EXPECT_TRUE(value == 10.0 || value == 2.5 || value == -5.0) << value;
  }
  EXPECT_TRUE(twice && half && negative);
}

// A tenth of the span in a second: 100, and so 2 in a period.
TEST(FaultySignal, ADriftMovesAwaySteadily) {
  const auto out = Ramp(FaultKind::kDrifting, 50);
  for (int i = 0; i < 50; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(out[k].value - (5.0 + i), 2.0 * (i + 1), 1e-9);
  }
}

// A first-order lag of T behind a ramp of slope 1 a period stays T / period = 10 behind it.
TEST(FaultySignal, ASlowOneLagsByAFifthOfASecond) {
  EXPECT_NEAR(205.0 - 1.0 - Ramp(FaultKind::kSlow, 200).back().value, 10.0, 1.0);
}

TEST(FaultySignal, GarbageFillsTheSpanAndHalfOfAnIntermittentOneIsMissing) {
  const auto garbage = Ramp(FaultKind::kGarbage, 1000), gaps = Ramp(FaultKind::kIntermittent, 1000);
  double lowest = 0.0, highest = 0.0;
  int missing = 0;
  for (const FaultySignal::Value& value : garbage) {
    lowest = std::min(lowest, value.value);
    highest = std::max(highest, value.value);
  }
  for (const FaultySignal::Value& value : gaps) missing += value.is_valid ? 0 : 1;
  EXPECT_GE(lowest, -kSpan);
  EXPECT_LE(highest, kSpan);
  EXPECT_LT(lowest, -0.9 * kSpan);
  EXPECT_GT(highest, 0.9 * kSpan);
  EXPECT_NEAR(missing, 500, 80);  // five standard deviations of a fair coin
}

}  // namespace
}  // namespace flexarm
