#include "estimator/delay_detector.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "tests/support/no_alloc.h"

namespace flexarm {
namespace {

using Misfit = DelayDetector::Misfit;

// @returns samples until the detector switches to another hypothesis; 0: not within a thousand
int SamplesUntilAnother(DelayDetector* detector, const Misfit& misfit) {
  for (int k = 1; k <= 1000; ++k) {
    if (detector->Take(misfit)) return k;
  }
  return 0;
}

TEST(DelayDetector, KeepsTheDeclaredDelayWhileAllHypothesesExplainTheSame) {
  DelayDetector detector;
  EXPECT_EQ(SamplesUntilAnother(&detector, Misfit{9.0, 9.0, 9.0, 9.0}), 0);
  EXPECT_EQ(detector.samples(), 0);
  EXPECT_EQ(detector.lead(), 0.0);
}

// A constant difference adds up to 1 / (1 - 0.99) = 100 times itself.
TEST(DelayDetector, ForgettingKeepsASmallDifferenceFromSwitching) {
  DelayDetector detector;
  EXPECT_EQ(SamplesUntilAnother(&detector, Misfit{8.3, 8.3, 8.0, 8.3}), 0);
  EXPECT_NEAR(detector.lead(), 30.0, 0.01);
  EXPECT_GT(SamplesUntilAnother(&detector, Misfit{8.5, 8.5, 8.0, 8.5}), 0);
  EXPECT_EQ(detector.samples(), 1);
}

// 5 (1 - 0.99^k) / 0.01 is 38.6 after eight samples, 43.2 after nine.
TEST(DelayDetector, SwitchesToTheHypothesisThatIsBetterByForty) {
  for (const int samples : {-1, 1, 2}) {
    DelayDetector detector;
    Misfit misfit = {13.0, 13.0, 13.0, 13.0};
    misfit[static_cast<std::size_t>(1 + samples)] = 8.0;
    EXPECT_EQ(SamplesUntilAnother(&detector, misfit), 9);
    EXPECT_EQ(detector.samples(), samples);
    EXPECT_EQ(detector.lead(), 0.0) << "all sums restart at zero";
    EXPECT_FALSE(detector.Take({45.0, 6.0, 45.0, 45.0})) << "39 are not enough to switch back";
    EXPECT_NEAR(detector.lead(), 39.0, 1e-12);
    EXPECT_TRUE(detector.Take({30.0, 28.0, 30.0, 30.0})) << "0.99 of them and 2 are";
    EXPECT_EQ(detector.samples(), 0);
  }
}

// Such as an impact, or a lost payload: the sample is neither added nor discounted.
TEST(DelayDetector, ASampleThatNoHypothesisExplainsIsIgnored) {
  DelayDetector detector;
  ASSERT_FALSE(detector.Take({45.0, 45.0, 6.0, 45.0}));
  EXPECT_FALSE(detector.Take({60.0, 60.0, 33.0, 60.0}));
  EXPECT_FALSE(detector.Take({1e4, 2e4, 3e4, 4e4}));
  EXPECT_NEAR(detector.lead(), 39.0, 1e-12);
  EXPECT_TRUE(detector.Take({60.0, 60.0, 31.0, 60.0}));
}

// One bad sample of the current hypothesis adds at most 200 to its sum.
TEST(DelayDetector, ASampleAddsAtMostTwoHundred) {
  DelayDetector detector;
  ASSERT_FALSE(detector.Take({10.0, 0.0, 10.0, 10.0}));
  ASSERT_EQ(SamplesUntilAnother(&detector, {9.0, 8.0, 9.0, 9.0}), 0);
  detector.Take({30.0, 1e4, 1e3, 1e5});
  EXPECT_EQ(detector.samples(), -1);
}

TEST(DelayDetector, AnImpossibleDelayIsNeverSelected) {
  DelayDetector detector;
  EXPECT_EQ(SamplesUntilAnother(&detector, {std::nullopt, 10.0, 10.0, std::nullopt}), 0);
  EXPECT_EQ(detector.samples(), 0);
}

TEST(DelayDetector, NanCountsAsTheLargestNis) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  DelayDetector detector;
  EXPECT_FALSE(detector.Take({nan, 0.0, nan, nan}));
  EXPECT_FALSE(detector.Take({nan, nan, nan, nan}));
  EXPECT_EQ(detector.samples(), 0);
  detector.Reset();
  EXPECT_TRUE(detector.Take({std::nullopt, nan, 0.0, nan}));
  EXPECT_EQ(detector.samples(), 1);
}

TEST(DelayDetector, ResetReturnsToTheDeclaredDelay) {
  DelayDetector detector;
  ASSERT_TRUE(detector.Take({45.0, 45.0, 0.0, 45.0}));
  detector.Take({0.0, 0.0, 3.0, 0.0});
  detector.Reset();
  EXPECT_EQ(detector.samples(), 0);
  EXPECT_EQ(detector.lead(), 0.0);
}

TEST(DelayDetector, DoesNotAllocate) {
  DelayDetector detector;
  const NoAlloc armed;
  EXPECT_EQ(SamplesUntilAnother(&detector, Misfit{13.0, 13.0, 8.0, 13.0}), 9);
}

}  // namespace
}  // namespace flexarm
