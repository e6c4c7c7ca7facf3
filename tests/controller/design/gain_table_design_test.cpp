// Gain table over payload and elbow angle: against the numbers of an independent program, and in a
// loop with an arm with four modes a link and elastic joints.

#include "controller/design/gain_table_design.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

#include "controller/law/scheduling_payload.h"
#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/units.h"
#include "tests/support/golden_data.h"
#include "tests/support/loop_time.h"
#include "tests/support/no_alloc.h"
#include "tests/support/study_gains.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

const GainTable& StudyTable() {
  static const GainTable table =
      DesignGainTable(RigidJointArm(ThesisRig()), StudyGrid(), StudyWeights(3.0), kPeriod_s);
  return table;
}

// Largest |z| of the loop of K and the arm with four modes a link, at a payload and an elbow angle.
// K uses the first two modes of each link.
double SpectralRadius(const GainTable::Gain& K, double payload_kg, double theta2_rad) {
  ArmParameters p = ThesisRig();
  p.payload_mass_kg = payload_kg;
  const ArmModel model(p, {4, 4});
  const Eigen::Index dof = model.dof();
  VectorXd q = VectorXd::Zero(dof);
  q[kTheta2] = q[kTheta4] = theta2_rad;
  const LinearModel linear = Linearize(model, q, VectorXd::Zero(dof), Eigen::Vector2d::Zero());
  const DiscreteModel plant = ZeroOrderHold(linear.A, linear.B, kPeriod_s);
  const std::array<int, 6> known = {kTheta1, kTheta2, kPhi1, kPhi1 + 1, kPhi1 + 4, kPhi1 + 5};
  MatrixXd gain = MatrixXd::Zero(2, 2 * dof);
  for (int i = 0; i < 6; ++i) {
    gain.col(known[static_cast<std::size_t>(i)]) = K.col(i);
    gain.col(dof + known[static_cast<std::size_t>(i)]) = K.col(6 + i);
  }
  const MatrixXd closed = plant.A - plant.B * gain;
  return closed.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(GainTable, AgreesWithTheGoldenTable) {
  const auto golden = GoldenFile("beyond-golden.json");
  const GainGrid grid = StudyGrid();
  for (std::size_t m = 0; m < grid.payload_kg.size(); ++m) {
    for (std::size_t th2 = 0; th2 < grid.theta2_rad.size(); ++th2) {
      const auto K = StudyTable().At(grid.payload_kg[m], grid.theta2_rad[th2]);
      EXPECT_LT(RelativeError(K, AsMatrix(golden["K"][m][th2])), 1e-6) << m << ' ' << th2;
    }
  }
  const MatrixXd between = AsMatrix(golden["K_at_m.37_th.5"]);
  EXPECT_LT(RelativeError(StudyTable().At(0.37, 0.5), between), 1e-6);
  EXPECT_LT(RelativeError(StudyTable().At(0.37, -0.5), between), 1e-6);
}

TEST(GainTable, IsConstantBeyondItsBorders) {
  EXPECT_EQ(StudyTable().At(-0.1, 0.5), StudyTable().At(0.0, 0.5));
  EXPECT_EQ(StudyTable().At(1.2, 0.5), StudyTable().At(1.0, 0.5));
  EXPECT_EQ(StudyTable().At(0.3, 3.0), StudyTable().At(0.3, 150.0 * kRadPerDeg));
}

// docs/theory/payload.md 4.2: max |z| on the 4-mode plant is .885-.894, on and off the grid. These
// are far from every knot.
TEST(GainTable, StabilizesTheArmWithFourModesBetweenItsKnots) {
  for (const double payload_kg : {0.02, 0.14, 0.28, 0.43, 0.62, 0.9}) {
    for (const double theta2_deg : {10.0, 50.0, 90.0, 135.0}) {
      const double theta2_rad = theta2_deg * kRadPerDeg;
      const auto K = StudyTable().At(payload_kg, theta2_rad);
      EXPECT_LT(SpectralRadius(K, payload_kg, theta2_rad), 0.90) << payload_kg << ' ' << theta2_deg;
    }
  }
}

// The reason for SchedulingPayload, docs/theory/payload.md 4.3.
TEST(GainTable, GainsOf150GramsStabilizeEveryPayloadThoseOfAKilogramDoNot) {
  for (const double theta2_deg : {0.0, 60.0, 120.0}) {
    const double theta2_rad = theta2_deg * kRadPerDeg;
    const auto robust = StudyTable().At(0.15, theta2_rad);
    for (const double payload_kg : {0.0, 0.05, 0.3, 0.6, 1.0}) {
      EXPECT_LT(SpectralRadius(robust, payload_kg, theta2_rad), 0.99)
          << payload_kg << ' ' << theta2_deg;
    }
  }
  EXPECT_GT(SpectralRadius(StudyTable().At(1.0, 0.0), 0.1, 0.0), 1.0);
  EXPECT_GT(SpectralRadius(StudyTable().At(0.5, 0.0), 0.05, 0.0), 1.0);
}

TEST(GainTable, RefusesAnInvalidGrid) {
  const std::vector<GainTable::Gain> knots(4, GainTable::Gain::Zero());
  EXPECT_THROW(GainTable({.payload_kg = {0, 0}, .theta2_rad = {0, 1}}, knots),
               std::invalid_argument);
  EXPECT_THROW(GainTable({.payload_kg = {0, 1}, .theta2_rad = {1}}, knots), std::invalid_argument);
  EXPECT_THROW(GainTable({.payload_kg = {0, 1, 2}, .theta2_rad = {0, 1}}, knots),
               std::invalid_argument);
}

TEST(GainTable, DoesNotAllocate) {
  const GainTable& table = StudyTable();
  const NoAlloc armed;
  EXPECT_GT(table.At(0.37, 0.5)(0, 0), 0.0);
}

TEST(SchedulingPayload, IsTheEstimateWhenItIsCertain) {
  EXPECT_EQ(SchedulingPayload(0.8, 0.0, 8.0, 0.0, 1.0), 0.8);
  EXPECT_EQ(SchedulingPayload(0.8, 0.0, 20.0, 2.0, 1.0), 0.8);
  EXPECT_EQ(SchedulingPayload(0.05, 0.3, 200.0, 2.0, 1.0), 0.05)
      << "light gains are not made heavier";
}

// The shares are of the greatest payload: an arm for 4 kg has four times as much of everything.
TEST(SchedulingPayload, IsAShareOfTheGreatestPayload) {
  EXPECT_DOUBLE_EQ(SchedulingPayload(2.2, 0.2, 8.0, 0.0, 4.0), 4.0 * (0.55 - 0.25 * 0.40));
  EXPECT_DOUBLE_EQ(SchedulingPayload(2.2, 0.0, 8.0, 2.01, 4.0), 0.6);
}

TEST(SchedulingPayload, FallsTo150GramsWithUncertainty) {
  EXPECT_DOUBLE_EQ(SchedulingPayload(0.55, 0.05, 8.0, 0.0, 1.0), 0.55 - 0.25 * 0.40);
  EXPECT_DOUBLE_EQ(SchedulingPayload(0.55, 0.4, 8.0, 0.0, 1.0), 0.15);
  EXPECT_DOUBLE_EQ(SchedulingPayload(0.55, 0.0, 40.0, 0.0, 1.0), 0.35);
  EXPECT_DOUBLE_EQ(SchedulingPayload(0.55, 0.05, 40.0, 0.0, 1.0), 0.35)
      << "the greater uncertainty counts";
  EXPECT_DOUBLE_EQ(SchedulingPayload(0.55, 0.0, 100.0, 0.0, 1.0), 0.15);
  EXPECT_DOUBLE_EQ(SchedulingPayload(0.55, 0.0, 8.0, 2.01, 1.0), 0.15);
}

}  // namespace
}  // namespace flexarm
