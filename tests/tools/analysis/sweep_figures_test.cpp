#include "tools/analysis/sweep_figures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace flexarm {
namespace {

ParametricSweep SweepOver(const std::vector<double>& parameters) {
  ParametricSweep sweep{"x", "x", parameters.front(), {}};
  for (const double value : parameters) sweep.point.push_back({value, {}, {}, 0.0});
  return sweep;
}

TEST(SweepFigures, RisingToleratesScatterOnly) {
  EXPECT_TRUE(Rises({1.0, 1.2, 1.196, 1.4}));
  EXPECT_FALSE(Rises({1.0, 1.2, 1.19, 1.4})) << "falls by 0.8 %";
  EXPECT_FALSE(Rises({1.0, 1.002})) << "the rise is within the scatter";
  EXPECT_TRUE(Falls({1.4, 1.2, 1.0}));
  EXPECT_FALSE(Falls({1.0, 1.2}));
  EXPECT_FALSE(Rises({1.0, std::nan("")}));
}

TEST(SweepFigures, ComputeExtremesSpreadAndDrop) {
  const ParametricSweep sweep = SweepOver({0.1, 0.2, 0.3, 0.4});
  const std::vector<double> values = {4.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(ParameterOfLargest(sweep, values), 0.1);
  EXPECT_EQ(ParameterOfLeast(sweep, values), 0.2);
  EXPECT_DOUBLE_EQ(SpreadInPercent(values), 120.0);
  EXPECT_DOUBLE_EQ(DropInPercent(values), 50.0);
  EXPECT_EQ(From(0.25, sweep, values), (std::vector<double>{3.0, 2.0}));
}

TEST(SweepFigures, ComputeExponentBowAndCorrelation) {
  const ParametricSweep sweep = SweepOver({1.0, 2.0, 3.0});
  EXPECT_NEAR(Exponent(sweep, {5.0, 5.0 / 4.0, 5.0 / 9.0}), -2.0, 1e-12);
  EXPECT_NEAR(BowInPercent(sweep, {1.0, 4.0, 9.0}), 12.5, 1e-12);  // (x-1)(3-x) = 1 of 8
  EXPECT_NEAR(BowInPercent(sweep, {7.0, 5.0, 3.0}), 0.0, 1e-12);
  EXPECT_NEAR(Correlation({1.0, 2.0, 3.0}, {-2.0, -4.0, -6.0}), -1.0, 1e-12);
  EXPECT_NEAR(Correlation({1.0, 2.0, 3.0}, {1.0, 0.0, 1.0}), 0.0, 1e-12);
}

TEST(SweepFigures, RemainingBendingIsRelativeToTheFirstPoint) {
  ParametricSweep sweep = SweepOver({0.0, 1.0});
  sweep.point[0].signal[kBending2].free_rms = 4.0;
  sweep.point[1].signal[kBending2].free_rms = 3.0;
  EXPECT_EQ(LeftInPercent(sweep, kBending2), (std::vector<double>{100.0, 75.0}));
}

}  // namespace
}  // namespace flexarm
