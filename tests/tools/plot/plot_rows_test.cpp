// The rows of the curves of a run: gaps, and long runs.

#include "tools/plot/plot_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/tools/plot/plotted_run.h"

namespace flexarm {
namespace {

TEST(PlotRows, AreTheSamplesOfAShortRun) {
  const PlotRun run = PlottedRun(100);
  const auto rows = PlotRows(run, 1000);
  ASSERT_EQ(rows.size(), 100U);
  EXPECT_EQ(rows[7][kTimeColumn], run.sample[7].time_s);
  EXPECT_EQ(rows[7][kAngleColumn + 1], run.sample[7].angle_deg[1]);
  EXPECT_EQ(rows[7][kStrainColumn], 100.0 * run.sample[7].strain_share[0]);
  EXPECT_EQ(rows[7][kSigmaColumn], run.sample[7].payload_sigma_kg);
}

// One sample in 100,000 is a peak of each sign.
TEST(PlotRows, OfALongRunLoseNoPeak) {
  PlotRun run = PlottedRun(100'000);
  run.sample[12'345].applied_nm[0] = 29.0;
  run.sample[67'890].applied_nm[0] = -28.0;
  run.sample[12'345].payload_sigma_kg = 0.5;
  const auto rows = PlotRows(run, 2000);
  EXPECT_EQ(rows.size(), 2000U);
  const auto wide = std::count_if(rows.begin(), rows.end(),
                                  [](const PlotRow& row) { return row[kSigmaColumn] == 0.5; });
  EXPECT_EQ(wide, 2) << "the band is as wide in both rows of the part";
  const ValueRange range = RangeOf(rows, kAppliedColumn);
  EXPECT_EQ(range.low, -28.0);
  EXPECT_EQ(range.high, 29.0);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_GE(rows[i][kTimeColumn], rows[i - 1][kTimeColumn]);
  }
}

TEST(PlotRows, HaveARowWithoutValuesWhereSamplesAreMissing) {
  PlotRun run = PlottedRun(10);
  run.sample.erase(run.sample.begin() + 4, run.sample.begin() + 6);
  run.gap.push_back({run.sample[3].time_s, run.sample[4].time_s, 2});
  const auto rows = PlotRows(run, 1000);
  ASSERT_EQ(rows.size(), 9U);
  EXPECT_TRUE(std::isnan(rows[4][kAngleColumn]));
  EXPECT_GT(rows[4][kTimeColumn], rows[3][kTimeColumn]);
  EXPECT_LT(rows[4][kTimeColumn], rows[5][kTimeColumn]);
}

TEST(PlotRows, TheRangeIsThatOfTheFiniteValues) {
  PlotRun run = PlottedRun(3);
  for (PlotRun::Sample& sample : run.sample) sample.target_mm = std::nan("");
  EXPECT_TRUE(RangeOf(PlotRows(run, 100), kTargetColumn).empty());
  run.sample[1].target_mm = 3.0;
  EXPECT_EQ(RangeOf(PlotRows(run, 100), kTargetColumn).low, 3.0);
}

TEST(NiceStep, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_NEAR(NiceStep(94.0, 6), 20.0, 1e-9);
  EXPECT_NEAR(NiceStep(0.5, 5), 0.1, 1e-9);
  EXPECT_NEAR(NiceStep(3600.0, 10), 500.0, 1e-9);
  EXPECT_NEAR(NiceStep(61.0, 6), 20.0, 1e-9);
}

}  // namespace
}  // namespace flexarm
