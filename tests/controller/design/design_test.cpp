// The design against golden.json (from an independent program), and against the lemma (7.16).
// Compared as max |X - G| / max |G|; bars of the design study: 1e-8, gains 1e-6.

#include "controller/law/design.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "controller/design/design_controller.h"
#include "controller/types/rejected_error.h"
#include "model/math/dense_decompositions.h"
#include "tests/controller/design/golden_design.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr double kMatrix = 1e-8, kGain = 1e-6;

class DesignTest : public testing::Test {
 protected:
  const Design& design_ = ShippedDesign();
};

TEST_F(DesignTest, ModelRegulatorAndLemmaMatricesAgreeWithTheGoldenOnes) {
  ExpectGolden(
      "R12",
      {{"A", design_.A}, {"B", design_.B}, {"P", design_.P}, {"J", design_.J}, {"G", design_.G}},
      kMatrix);
  ExpectGolden("R12", {{"K", design_.K}, {"Cp", design_.K}}, kGain);
}

TEST_F(DesignTest, FilterAgreesWithTheGoldenOne) {
  ExpectGolden("KF", {{"Aa", design_.filter_A}, {"Ba", design_.filter_B}, {"C", design_.filter_C}},
               kMatrix);
  ExpectGolden("KF", {{"L", design_.filter_L}}, kGain);
}

// The golden reference model has its torque modes rounded to four decimals (relative 1e-6), this
// one exact modes; all derived values differ by as much.
TEST_F(DesignTest, ReferenceAndFeedforwardAgreeWithinTheRoundingOfTheGoldenOnes) {
  ExpectGolden("R12",
               {{"Am", design_.Am},
                {"Bm", design_.Bm},
                {"S11", design_.S11},
                {"S12", design_.S12},
                {"S21", design_.S21},
                {"S22", design_.S22},
                {"Ufx", design_.Ufx},
                {"Ufu", design_.Ufu}},
               1e-6);
}

// docs/theory/control-law.md 2.2: M_r = [[2.864, 0.308], [0.308, 0.1529]] kg m^2 (four digits).
TEST_F(DesignTest, RigidInertiaIsThatOfTheStudy) {
  EXPECT_NEAR(design_.rigid_inertia_kgm2(0, 0), 2.864, 5e-4);
  EXPECT_NEAR(design_.rigid_inertia_kgm2(0, 1), 0.308, 5e-4);
  EXPECT_NEAR(design_.rigid_inertia_kgm2(1, 1), 0.1529, 5e-5);
}

// Lemma (7.16) with W = 0: A_c' P B = K' and L L' = P - A_c' P A_c >= 0. Round-off of products with
// P's largest entries: 1e-9 measured; a P without its e^(2 alpha Ts) is off by 12 %.
TEST_F(DesignTest, TheLemmaHoldsWithTheClosedFormOfP) {
  const MatrixXd A_c = design_.A - design_.B * design_.K;
  EXPECT_LT(RelativeError(A_c.transpose() * design_.P * design_.B, design_.K.transpose()), 1e-8);
  const MatrixXd LLt = design_.P - A_c.transpose() * design_.P * A_c;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(0.5 * (LLt + LLt.transpose()));
  EXPECT_GT(eigen.eigenvalues()(0), -1e-12 * design_.P.cwiseAbs().maxCoeff());
  EXPECT_LT(RelativeError(design_.J, 0.5 * design_.B.transpose() * design_.P * design_.B), 1e-12);
}

// Smallest eigenvalue of S + S*, S = J + K (zI - A_c)^-1 B, on the circle: 1.8 in the design study.
// Evaluated on another grid than that of the design's own check, which must agree.
TEST_F(DesignTest, TheClosedLoopIsPositiveReal) {
  const MatrixXcd A_c = (design_.A - design_.B * design_.K).cast<std::complex<double>>();
  double smallest = 1e9;
  for (int i = 0; i < 1000; ++i) {
    const std::complex<double> z = std::polar(1.0, std::numbers::pi * (i + 0.5) / 1000);
    const MatrixXcd S =
        design_.J.cast<std::complex<double>>() +
        design_.K.cast<std::complex<double>>() * (z * MatrixXcd::Identity(12, 12) - A_c)
                                                     .partialPivLu()
                                                     .solve(design_.B.cast<std::complex<double>>());
    const Eigen::SelfAdjointEigenSolver<MatrixXcd> eigen(MatrixXcd(S + S.adjoint()));
    smallest = std::min(smallest, eigen.eigenvalues()(0));
  }
  EXPECT_NEAR(smallest, 1.8, 0.05);
  const auto check = std::find_if(design_.checks.begin(), design_.checks.end(), [](const auto& c) {
    return c.name == "positive-real-min-eigenvalue";
  });
  ASSERT_NE(check, design_.checks.end());
  EXPECT_NEAR(check->value, smallest, 0.01);
}

// Invariant zeros of (A, B, K): eigenvalues of A - B (KB)^-1 K A but for two at 0. The design
// study: up to |z| = 2.3 outside the circle, and 0.048 away from 1, where the CGT would have no
// solution.
TEST_F(DesignTest, DiscreteZerosLieWhereTheStudyFoundThem) {
  const MatrixXd KB = design_.K * design_.B;
  const MatrixXd zero_dynamics = design_.A - design_.B * KB.inverse() * design_.K * design_.A;
  const Eigen::VectorXcd zeros = zero_dynamics.eigenvalues();
  double largest = 0.0, nearest = 1e9;
  for (Eigen::Index i = 0; i < zeros.size(); ++i) {
    largest = std::max(largest, std::abs(zeros(i)));
    nearest = std::min(nearest, std::abs(zeros(i) - 1.0));
  }
  EXPECT_NEAR(largest, 2.3, 0.05);
  EXPECT_NEAR(nearest, 0.048, 5e-4);
}

// (3.2): every closed-loop pole inside e^(-alpha Ts).
TEST_F(DesignTest, ThePrescribedDegreeOfStabilityIsReached) {
  for (const double alpha : {0.0, 2.0, 3.0}) {
    const Design design =
        DesignController(ShippedRig({"controller.alpha=" + std::to_string(alpha)}));
    const MatrixXd A_c = design.A - design.B * design.K;
    EXPECT_LT(A_c.eigenvalues().cwiseAbs().maxCoeff(), std::exp(-alpha * 0.02) + 1e-9) << alpha;
  }
}

// For alpha 0 the design study gives J = diag 1.2 and 2.0 (two digits).
TEST_F(DesignTest, JGrowsWithAlpha) {
  const Design design = DesignController(ShippedRig({"controller.alpha=0.0"}));
  EXPECT_NEAR(design.J(0, 0), 1.2, 0.05);
  EXPECT_NEAR(design.J(1, 1), 2.0, 0.05);
}

// K_stop is the regulator without prescribed degree of stability: the K of alpha = 0.
TEST_F(DesignTest, TheStopGainIsTheRegulatorWithoutPrescribedStability) {
  const Design design = DesignController(ShippedRig({"controller.alpha=0.0"}));
  EXPECT_LT(RelativeError(design_.K_stop, design.K), 1e-9);
}

TEST_F(DesignTest, EveryCheckOfTheShippedDesignPassed) {
  EXPECT_TRUE(design_.sound());
  EXPECT_GE(design_.checks.size(), 10u);
  for (const DesignCheck& check : design_.checks) {
    EXPECT_TRUE(check.passed()) << check.name << " " << check.value << " " << check.limit;
  }
}

TEST_F(DesignTest, ADesignWithAFailedOrNanCheckIsNotSound) {
  Design design = design_;
  design.checks.front().value = 1.0;
  EXPECT_FALSE(design.sound());
  design.checks.front().value = std::nan("");
  EXPECT_FALSE(design.sound());
}

// The printed rig is ten times as stiff and heavy: another design, also sound.
TEST_F(DesignTest, ThePrintedRigHasASoundDesign) {
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/thesis-rig-printed.toml");
  EXPECT_TRUE(DesignController(config).sound());
}

TEST_F(DesignTest, OneModeALinkHasASoundDesignOfEightStates) {
  const Design design = DesignController(ShippedRig({"controller.nominal=R8"}));
  EXPECT_EQ(design.A.rows(), 8);
  EXPECT_TRUE(design.sound());
}

}  // namespace
}  // namespace flexarm
