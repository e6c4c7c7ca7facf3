// The linear model and the filter against golden.json, from another program. Compared as
// max |X - G| / max |G|; bounds of the design study: 1e-8, gains 1e-6.

#include <gtest/gtest.h>

#include "estimator/nominal_model.h"
#include "model/math/discretize.h"
#include "tests/estimator/thesis_estimator.h"
#include "tests/support/golden_data.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;

class EstimatorGolden : public testing::Test {
 protected:
  const nlohmann::json golden_ = GoldenFile("golden.json");
  const NominalModel nominal_ = MakeNominalModel(ThesisRig(), kR12);
};

TEST_F(EstimatorGolden, ContinuousNominalModelAgrees) {
  EXPECT_LT(RelativeError(nominal_.A, AsMatrix(golden_["R12_Ac"])), 1e-8);
  EXPECT_LT(RelativeError(nominal_.B, AsMatrix(golden_["R12_Bc"])), 1e-8);
}

TEST_F(EstimatorGolden, DiscreteNominalModelAgrees) {
  const DiscreteModel discrete = ZeroOrderHold(nominal_.A, nominal_.B, kPeriod_s);
  EXPECT_LT(RelativeError(discrete.A, AsMatrix(golden_["R12_A"])), 1e-8);
  EXPECT_LT(RelativeError(discrete.B, AsMatrix(golden_["R12_B"])), 1e-8);
}

// docs/theory/control-law.md 1.2 has the two lowest torque modes: 42.0 and 55.6 rad/s (6.69 and
// 8.85 Hz).
TEST_F(EstimatorGolden, TorqueModesAgreeWithTheStudy) {
  ASSERT_EQ(nominal_.torque_mode_rad_s.size(), 4);
  EXPECT_NEAR(nominal_.torque_mode_rad_s(0), 42.0450, 5e-5);
  EXPECT_NEAR(nominal_.torque_mode_rad_s(1), 55.6125, 5e-5);
}

// The golden reference model was made with those frequencies rounded to four decimals; with the
// rounded ones, the model must agree to round-off.
TEST_F(EstimatorGolden, ReferenceModelWithTheRoundedTorqueModesAgrees) {
  NominalModel rounded = nominal_;
  rounded.torque_mode_rad_s(0) = 42.0450;
  rounded.torque_mode_rad_s(1) = 55.6125;
  const NominalModel reference = MakeReferenceModel(rounded);
  const DiscreteModel discrete = ZeroOrderHold(reference.A, reference.B, kPeriod_s);
  EXPECT_LT(RelativeError(discrete.A, AsMatrix(golden_["R12_Am"])), 1e-9);
  EXPECT_LT(RelativeError(discrete.B, AsMatrix(golden_["R12_Bm"])), 1e-9);
}

// The exact ones differ in the sixth digit of a damping, which moves the largest entry by 1e-7.
TEST_F(EstimatorGolden, ReferenceModelWithTheExactTorqueModesIsClose) {
  const NominalModel reference = MakeReferenceModel(nominal_);
  const DiscreteModel discrete = ZeroOrderHold(reference.A, reference.B, kPeriod_s);
  EXPECT_LT(RelativeError(discrete.A, AsMatrix(golden_["R12_Am"])), 1e-6);
}

TEST_F(EstimatorGolden, FilterAgrees) {
  const KalmanDesign filter = ThesisFilter();
  EXPECT_LT(RelativeError(filter.A, AsMatrix(golden_["KF_Aa"])), 1e-8);
  EXPECT_LT(RelativeError(filter.B, AsMatrix(golden_["KF_Ba"])), 1e-8);
  EXPECT_LT(RelativeError(filter.C, AsMatrix(golden_["KF_C"])), 1e-8);
  EXPECT_LT(RelativeError(filter.L, AsMatrix(golden_["KF_L"])), 1e-6);
}

}  // namespace
}  // namespace flexarm
