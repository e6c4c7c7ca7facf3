#include "tools/bench_host/timing.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

TEST(Timing, QuantilesLieBetweenTheSamplesLinearly) {
  const std::vector<double> samples = {4.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(Quantile(samples, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(Quantile(samples, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(Quantile(samples, 0.25), 1.75);
  EXPECT_DOUBLE_EQ(Quantile(samples, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(Quantile({7.0}, 0.75), 7.0);
}

TEST(Timing, OneSlowRepetitionChangesNeitherMedianNorQuartiles) {
  const Timing timing = TimingOf({1.0, 1.0, 1.0, 1.0, 1000.0});
  EXPECT_DOUBLE_EQ(timing.median_s, 1.0);
  EXPECT_DOUBLE_EQ(timing.upper_quartile_s, 1.0);
  EXPECT_DOUBLE_EQ(timing.least_s, 1.0);
  EXPECT_EQ(timing.repetitions, 5U);
}

TEST(Timing, RepeatsAsOftenAsItIsTold) {
  int calls = 0;
  const Timing timing = TimeWork([&calls] { ++calls; }, {.count = 7, .each_s = 0.0});
  EXPECT_EQ(timing.repetitions, 7U);
  EXPECT_EQ(calls, 9);  // one for what a first call does, one to see how long it takes
  EXPECT_LE(timing.lower_quartile_s, timing.upper_quartile_s);
}

}  // namespace
}  // namespace flexarm
