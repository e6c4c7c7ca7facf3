#include "controller/reference/reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/design/design_controller.h"
#include "controller/types/rejected_error.h"
#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/golden_data.h"
#include "tests/support/loop_time.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

Experiment Doublets(std::vector<Doublet> doublets, double duration_s = 6.0) {
  return {.name = "test",
          .text = "",
          .duration_s = duration_s,
          .doublet = std::move(doublets),
          .sim_event = {}};
}

Doublet MoveBy(double th1_deg, double th2_deg, double start_s = 0.0, double duration_s = 1.0,
               DoubletShape shape = DoubletShape::kSquare) {
  return {
      .start_s = start_s, .duration_s = duration_s, .shape = shape, .move_deg = {th1_deg, th2_deg}};
}

// The soft angles of the rig and no other limit: these doublets only test the arithmetic.
MotionLimits SoftAngles() {
  MotionLimits limits = ShippedLimits();
  for (auto* limit :
       {&limits.torque_nm, &limits.slew_nm_per_s, &limits.hub_rate_rad_s, &limits.strain}) {
    *limit = {1e6, 1e6};
  }
  return limits;
}

ReferenceTable Table(const Experiment& experiment, std::array<double, 2> start = {0.0, 0.0}) {
  return {experiment, ShippedDesign(), kPeriod_s, start, SoftAngles()};
}

const Experiment kBase = Doublets({MoveBy(30, 30), MoveBy(-30, -30, 3.0)});

// The golden amplitudes are M_r 4 dth / T^2 rounded to four decimals: M_r^-1 (5e-5, 5e-5) T^2 / 4
// is 1.2e-4 rad of joint 2, 2.3e-4 of its move.
TEST(ReferenceTable, BaseCommandIsTheGoldenOne) {
  const nlohmann::json golden = GoldenFile("golden.json");
  const Eigen::MatrixXd u_m = AsMatrix(golden["u_m"]), x_m = AsMatrix(golden["x_m"]);
  const ReferenceTable table = Table(kBase);
  ASSERT_EQ(table.periods(), 300);
  for (int k = 0; k < 300; ++k) {
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(table.At(k).u_m_nm[static_cast<std::size_t>(i)], u_m(k, i), 1e-4) << k;
    }
    for (int i = 0; i < 12; ++i) {
      const double size = x_m.col(i).cwiseAbs().maxCoeff();
      EXPECT_NEAR(table.At(k).x_m[static_cast<std::size_t>(i)], x_m(k, i), 3e-4 * size) << k;
    }
  }
}

// The golden reference model under this table's torques gives this table's motion, except for the
// rounding of its torque modes, 1e-6 of its damping.
TEST(ReferenceTable, AgreesWithTheGoldenReferenceModel) {
  const nlohmann::json golden = GoldenFile("golden.json");
  const Eigen::MatrixXd Am = AsMatrix(golden["R12_Am"]), Bm = AsMatrix(golden["R12_Bm"]);
  const Eigen::MatrixXd golden_x_m = AsMatrix(golden["x_m"]);
  const ReferenceTable table = Table(kBase);
  Eigen::VectorXd x_m = Eigen::VectorXd::Zero(12);
  for (int k = 0; k < 300; ++k) {
    const ReferenceSample& sample = table.At(k);
    for (int i = 0; i < 12; ++i) {
      const double size = golden_x_m.col(i).cwiseAbs().maxCoeff();
      ASSERT_NEAR(sample.x_m[static_cast<std::size_t>(i)], x_m(i), 1e-5 * size) << k;
    }
    x_m = Am * x_m + Bm * Eigen::Vector2d(sample.u_m_nm[0], sample.u_m_nm[1]);
  }
}

// A doublet of zero area on a double integrator moves by exactly the angle and leaves it at rest,
// when the bending has decayed: the slowest reference mode has critical damping at 42 rad/s, so
// after 4 s nothing is left but round-off.
TEST(ReferenceTable, ADoubletMovesByItsAngleAndEndsAtRest) {
  for (const DoubletShape shape : {DoubletShape::kSquare, DoubletShape::kSine}) {
    for (const double duration_s : {0.4, 1.0, 2.0}) {
      const ReferenceTable table = Table(Doublets({MoveBy(13, -7, 0.0, duration_s, shape)}));
      const ReferenceSample& end = table.At(table.periods());
      EXPECT_NEAR(end.x_m[0], 13 * kRadPerDeg, 1e-10) << duration_s;
      EXPECT_NEAR(end.x_m[1], -7 * kRadPerDeg, 1e-10) << duration_s;
      for (std::size_t i = 2; i < 12; ++i) EXPECT_NEAR(end.x_m[i], 0.0, 1e-9) << i;
    }
  }
}

TEST(ReferenceTable, DoubletsHaveZeroArea) {
  for (const DoubletShape shape : {DoubletShape::kSquare, DoubletShape::kSine}) {
    const ReferenceTable table = Table(Doublets({MoveBy(20, 10, 0.2, 0.8, shape)}));
    std::array<double, 2> area{};
    for (int k = 0; k < table.periods(); ++k) {
      for (std::size_t i = 0; i < 2; ++i) area[i] += table.At(k).u_m_nm[i] * kPeriod_s;
    }
    EXPECT_NEAR(area[0], 0.0, 1e-12);
    EXPECT_NEAR(area[1], 0.0, 1e-12);
    EXPECT_EQ(table.At(9).u_m_nm[0], 0.0);
    EXPECT_NE(table.At(10).u_m_nm[0], 0.0);
    EXPECT_NE(table.At(49).u_m_nm[0], 0.0);
    EXPECT_EQ(table.At(50).u_m_nm[0], 0.0);
  }
}

// At equal amplitude a continuous sine moves 2/pi as far, as the thesis reports, so for the same
// move it needs pi/2 the amplitude. Sampled and held at 50 points the figure differs by
// (pi/50)^2 / 6 = 0.07 %.
TEST(ReferenceTable, ASineNeedsHalfPiTimesTheAmplitude) {
  const ReferenceTable sine = Table(Doublets({MoveBy(30, 0, 0.0, 1.0, DoubletShape::kSine)}));
  const ReferenceTable square = Table(Doublets({MoveBy(30, 0)}));
  double peak = 0.0;
  for (int k = 0; k < 50; ++k) peak = std::max(peak, sine.At(k).u_m_nm[0]);
  EXPECT_NEAR(peak / square.At(0).u_m_nm[0], std::numbers::pi / 2.0, 0.004);
}

// The table is the reference model's own motion, sample by sample.
TEST(ReferenceTable, FollowsTheReferenceModelFromItsStart) {
  const ReferenceTable table = Table(kBase, {0.1, -0.2});
  Eigen::VectorXd x_m = Eigen::VectorXd::Zero(12);
  x_m(0) = 0.1;
  x_m(1) = -0.2;
  for (int k = 0; k <= 300; ++k) {
    const ReferenceSample& sample = table.At(k);
    for (int i = 0; i < 12; ++i) {
      ASSERT_NEAR(sample.x_m[static_cast<std::size_t>(i)], x_m(i), 1e-12) << k;
    }
    x_m = ShippedDesign().Am * x_m +
          ShippedDesign().Bm * Eigen::Vector2d(sample.u_m_nm[0], sample.u_m_nm[1]);
  }
}

// On torsional models the torque moves the rotors, and the hubs follow: both start untwisted at the
// start, twist during the move, and end untwisted at the target.
TEST(ReferenceTable, OnATorsionalModelItMovesRotorsAndHubs) {
  const Design design = DesignController(ShippedRig({"controller.nominal=T16"}));
  const ReferenceTable table(kBase, design, kPeriod_s, {0.1, -0.2}, SoftAngles());
  const double by = 30 * kRadPerDeg;
  double twist = 0.0;
  for (int k = 0; k <= 50; ++k) {
    twist = std::max(twist, std::fabs(table.At(k).x_m[2] - table.At(k).x_m[0]));
  }
  EXPECT_GT(twist, 1e-3);
  for (const auto& [k, moved] : {std::pair{-1, 0.0}, {0, 0.0}, {140, by}, {300, 0.0}}) {
    const auto& x_m = table.At(k).x_m;
    for (const std::size_t i : {0u, 2u}) {
      EXPECT_NEAR(x_m[i], 0.1 + moved, 1e-4) << k << ", coordinate " << i;
      EXPECT_NEAR(x_m[i + 1], -0.2 + moved, 1e-4) << k << ", coordinate " << i + 1;
    }
  }
}

TEST(ReferenceTable, RestsBeforeTheStartAndAfterTheEnd) {
  const ReferenceTable table = Table(kBase, {0.1, -0.2});
  EXPECT_EQ(table.At(-1).x_m[0], 0.1);
  EXPECT_EQ(table.At(-1).u_m_nm[0], 0.0);
  EXPECT_EQ(table.At(301).x_m, table.At(300).x_m);
  EXPECT_EQ(table.At(300).u_m_nm[0], 0.0);
}

std::string RefusalOf(const Experiment& experiment) {
  return MessageOf<RejectedError>([&] { Table(experiment); });
}

TEST(ReferenceTable, TimesOffTheSamplingGridAreRefusedByName) {
  EXPECT_THAT(RefusalOf(Doublets({MoveBy(10, 10), MoveBy(-10, -10, 3.01)})),
              AllOf(HasSubstr("doublet[1].start_s"), HasSubstr("3.01")));
  EXPECT_THAT(RefusalOf(Doublets({MoveBy(10, 10, 0.0, 1.005)})),
              HasSubstr("doublet[0].duration_s"));
  EXPECT_THAT(RefusalOf(Doublets({MoveBy(10, 10)}, 6.013)), HasSubstr("duration_s"));
}

TEST(ReferenceTable, AnOddNumberOfPeriodsIsRefused) {
  EXPECT_THAT(RefusalOf(Doublets({MoveBy(10, 10, 0.0, 0.98)})),
              AllOf(HasSubstr("doublet[0].duration_s"), HasSubstr("even")));
}

TEST(ReferenceTable, ALongSeriesOfDecimalTimesIsOnTheGrid) {
  EXPECT_EQ(RefusalOf(Doublets({MoveBy(5, 5, 0.06, 0.28), MoveBy(-5, -5, 1.14, 0.36)}, 3.3)), "");
}

TEST(ReferenceTable, LeavingTheSoftLimitIsRefusedWithJointAndInstant) {
  const std::string refusal = RefusalOf(Doublets({MoveBy(80, 0), MoveBy(30, 0, 2.0)}));
  EXPECT_THAT(refusal, AllOf(HasSubstr("joint 1"), HasSubstr("90"), HasSubstr("after 2.")));
  EXPECT_THAT(RefusalOf(Doublets({MoveBy(0, -95, 0.0, 2.0)})), HasSubstr("joint 2"));
  EXPECT_EQ(RefusalOf(Doublets({MoveBy(80, 0, 0.0, 2.0)})), "");
}

// The gate's slew limit does not trip; the thesis's square exceeds it in one period, and runs.
TEST(ReferenceTable, TheThesissExperimentsKeepTheLimitsOfTheRig) {
  for (const DoubletShape shape : {DoubletShape::kSquare, DoubletShape::kSine}) {
    const Experiment experiment =
        Doublets({MoveBy(30, 30, 0.0, 1.0, shape), MoveBy(-30, -30, 3.0, 1.0, shape)});
    EXPECT_NO_THROW(
        ReferenceTable(experiment, ShippedDesign(), kPeriod_s, {0.0, 0.0}, ShippedLimits()));
  }
}

TEST(ReferenceTable, ABrokenLimitIsRefusedWithItsRow) {
  try {
    const ReferenceTable table(Doublets({MoveBy(10, 10), MoveBy(60, 60, 2.0, 0.6)}),
                               ShippedDesign(), kPeriod_s, {0.0, 0.0}, ShippedLimits());
    FAIL() << "accepted";
  } catch (const RejectedError& refused) {
    EXPECT_THAT(refused.what(), AllOf(HasSubstr("doublet[1]: "), HasSubstr("beyond limits.")));
  }
}

// Half the command now and half of it ten samples later: the mean of two unshaped references.
TEST(ReferenceTable, AShaperDistributesTheCommandOverItsSamples) {
  Design shaped = ShippedDesign();
  shaped.shaper = Eigen::RowVectorXd::Zero(11);
  shaped.shaper(0) = shaped.shaper(10) = 0.5;
  const std::array<double, 2> start = {0.2, -0.1};
  const ReferenceTable plain = Table(kBase, start);
  const ReferenceTable table(kBase, shaped, kPeriod_s, start, SoftAngles());
  ASSERT_EQ(table.periods(), plain.periods());
  for (int k = 0; k <= 300; ++k) {
    for (std::size_t i = 0; i < 12; ++i) {
      EXPECT_NEAR(table.At(k).x_m[i], 0.5 * (plain.At(k).x_m[i] + plain.At(k - 10).x_m[i]), 1e-14);
    }
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(table.At(k).u_m_nm[i], 0.5 * (plain.At(k).u_m_nm[i] + plain.At(k - 10).u_m_nm[i]),
                  1e-14);
    }
  }
}

// The last move of the base command ends at 4 s of 6: 100 more periods remain, not 101.
TEST(ReferenceTable, AShapedMoveThatDoesNotEndWithTheExperimentIsRefused) {
  Design shaped = ShippedDesign();
  shaped.shaper = Eigen::RowVectorXd::Constant(101, 1.0 / 101);
  EXPECT_NO_THROW(ReferenceTable(kBase, shaped, kPeriod_s, {0.0, 0.0}, SoftAngles()));
  shaped.shaper = Eigen::RowVectorXd::Constant(102, 1.0 / 102);
  try {
    const ReferenceTable table(kBase, shaped, kPeriod_s, {0.0, 0.0}, SoftAngles());
    FAIL() << "accepted";
  } catch (const RejectedError& refused) {
    EXPECT_THAT(refused.what(), HasSubstr("ends after 6.02"));
  }
}

}  // namespace
}  // namespace flexarm
