#include "controller/reference/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/reference/reference.h"
#include "controller/types/rejected_error.h"
#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

// A half cosine of 2 s: at rest at both ends, smooth, at rows that are not on the grid.
double Swing(double t) { return 0.25 * (1.0 - std::cos(std::numbers::pi * t / 2.0)); }

CsvTrajectory Swinging(double step_s) {
  CsvTrajectory csv{.start_s = 1.0, .file = "swing.csv", .point = {}};
  for (double t = 0.0; t < 2.0 - 1e-9; t += step_s) {
    csv.point.push_back({.time_s = t, .angle_rad = {Swing(t), -0.5 * Swing(t)}});
  }
  csv.point.push_back({.time_s = 2.0, .angle_rad = {Swing(2.0), -0.5 * Swing(2.0)}});
  return csv;
}

// A clamped cubic spline errs by 5/384 h^4 max |y''''|, here 0.25 (pi/2)^4 = 1.52.
TEST(Trajectory, TheSplineIsTheFunctionBetweenItsRows) {
  for (const double h : {0.07, 0.13}) {
    const auto angle = TrajectoryOnGrid(Swinging(h), {0.0, 0.0}, kPeriod_s);
    ASSERT_EQ(angle[0].size(), 101U);
    for (std::size_t k = 0; k <= 100; ++k) {
      const double t = static_cast<double>(k) * kPeriod_s;
      EXPECT_NEAR(angle[0][k], Swing(t), 5.0 / 384.0 * 1.52 * std::pow(h, 4)) << k;
      EXPECT_NEAR(angle[1][k], -0.5 * Swing(t), 5.0 / 384.0 * 0.76 * std::pow(h, 4)) << k;
    }
  }
}

TEST(Trajectory, ADifferenceFromTheFirstRowIsFadedOut) {
  const auto exact = TrajectoryOnGrid(Swinging(0.1), {0.0, 0.0}, kPeriod_s);
  const auto away = TrajectoryOnGrid(Swinging(0.1), {0.01, 0.0}, kPeriod_s);
  EXPECT_NEAR(away[0].front(), 0.0, 1e-15);
  EXPECT_NEAR(away[0].back() + 0.01, exact[0].back(), 1e-15);
  EXPECT_NEAR(away[0][50] + 0.01, exact[0][50] + 0.005, 1e-12) << "half of it at half time";
}

Experiment Following(const CsvTrajectory& csv, double duration_s) {
  return {.name = "test",
          .text = "",
          .duration_s = duration_s,
          .doublet = {},
          .sim_event = {},
          .move = {{.start_s = 4.0, .duration_s = 1.0, .to_deg = {0, 0}}},
          .csv = csv};
}

// The reference's bending has decayed 1 s after a motion: critical damping at 42 rad/s.
TEST(Trajectory, TheReferenceFollowsItAndAMoveContinuesFromThere) {
  const ReferenceTable table(Following(Swinging(0.1), 7.0), ShippedDesign(), kPeriod_s,
                             {0.005, 0.0}, ShippedLimits());
  EXPECT_NEAR(table.At(199).x_m[0], Swing(2.0), 1e-9);
  EXPECT_NEAR(table.At(199).x_m[1], -0.5 * Swing(2.0), 1e-9);
  EXPECT_NEAR(table.moves()[0].from.angle_rad[0], Swing(2.0), 1e-15);
  EXPECT_NEAR(table.At(350).x_m[0], 0.0, 1e-9);
  EXPECT_NEAR(table.At(350).x_m[1], 0.0, 1e-9);
}

std::string RefusalOf(const CsvTrajectory& csv, double start_rad, double duration_s = 7.0) {
  Experiment experiment = Following(csv, duration_s);
  if (duration_s < 7.0) experiment.move.clear();
  return MessageOf<RejectedError>([&] {
    ReferenceTable(experiment, ShippedDesign(), kPeriod_s, {start_rad, 0.0}, ShippedLimits());
  });
}

TEST(Trajectory, AnInfeasibleTrajectoryIsRefused) {
  EXPECT_EQ(RefusalOf(Swinging(0.1), 0.9 * kRadPerDeg), "");
  EXPECT_THAT(RefusalOf(Swinging(0.1), 1.1 * kRadPerDeg),
              AllOf(HasSubstr("swing.csv: the first row puts joint 1 at 0 deg"), HasSubstr("1.1")));
  EXPECT_EQ(RefusalOf(Swinging(0.1), 0.0, 3.02), "");
  EXPECT_THAT(RefusalOf(Swinging(0.1), 0.0, 3.0), HasSubstr("one period after its last row"));
  CsvTrajectory late = Swinging(0.1);
  late.point.back().time_s = 2.01;
  EXPECT_THAT(RefusalOf(late, 0.0), HasSubstr("swing.csv: the last time_s"));
}

}  // namespace
}  // namespace flexarm
