// The model against numbers of other programs: tests/golden/golden.json and
// oracles.json.

#include <gtest/gtest.h>

#include <cmath>

#include "model/arm/arm_model.h"
#include "model/math/discretize.h"
#include "model/math/riccati.h"
#include "tests/support/golden_data.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Both sides have round-off only; the bound set with the golden data is 1e-8 of the largest entry.
// Measured: see each line. The smallest misprint of Appendix A changes an entry by 1e-3.
constexpr double kGolden = 1e-8;

class Golden : public testing::Test {
 protected:
  const nlohmann::json golden_ = GoldenFile("golden.json");
  const ArmModel arm_{ThesisRig(), {4, 4}};
  const VectorXd q_ = AsVector(golden_["test_q"]), v_ = AsVector(golden_["test_v"]);
};

TEST_F(Golden, BetasAndFrequenciesOfBothLinksAgree) {
  for (int link = 1; link <= 2; ++link) {
    const std::string n = std::to_string(link);
    const VectorXd beta = AsVector(golden_["beta" + n]), hz = AsVector(golden_["w" + n + "_hz"]);
    const LinkModes& modes = arm_.link_modes(link);
    for (int i = 0; i < 4; ++i) {
      const BeamMode& mode = modes.mode[static_cast<std::size_t>(i)];
      EXPECT_NEAR(mode.beta_length() / modes.length_m, beta[i], 1e-11 * beta[i]);
      EXPECT_NEAR(mode.frequency_rad_s() / (2.0 * M_PI), hz[i], 1e-11 * hz[i]);
    }
  }
}

TEST_F(Golden, TipSlopesAgree) {
  EXPECT_LT(RelativeError(arm_.link_modes(1).slope_tip, AsVector(golden_["psi1e_slope"])), kGolden);
  EXPECT_LT(RelativeError(arm_.link_modes(2).slope_tip, AsVector(golden_["psi2e_slope"])), kGolden);
}

TEST_F(Golden, StiffnessAndDampingOfTheLinksAgree) {
  for (int link = 1; link <= 2; ++link) {
    const std::string n = std::to_string(link);
    EXPECT_LT(RelativeError(arm_.link_modes(link).G, AsMatrix(golden_["G" + n])), kGolden);
    EXPECT_LT(RelativeError(arm_.link_modes(link).D, AsMatrix(golden_["D" + n])), kGolden);
  }
}

TEST_F(Golden, MassMatrixBiasAndTipAgreeAtTheTestState) {
  EXPECT_LT(RelativeError(arm_.MassMatrix(q_), AsMatrix(golden_["M"])), kGolden);
  EXPECT_LT(RelativeError(arm_.Bias(q_, v_), AsVector(golden_["bias"])), kGolden);
  EXPECT_LT(RelativeError(arm_.TipPosition(q_), AsVector(golden_["tip"])), kGolden);
}

TEST_F(Golden, OneModeMassMatrixAgreesAtZero) {
  const ArmModel one(ThesisRig(), {1, 1});
  EXPECT_LT(RelativeError(one.MassMatrix(VectorXd::Zero(6)), AsMatrix(golden_["M_T12_zero"])),
            kGolden);
}

TEST_F(Golden, ZeroOrderHoldOfTheReducedModelAgrees) {
  const auto hold = ZeroOrderHold(AsMatrix(golden_["R12_Ac"]), AsMatrix(golden_["R12_Bc"]), 0.02);
  EXPECT_LT(RelativeError(hold.A, AsMatrix(golden_["R12_A"])), kGolden);
  EXPECT_LT(RelativeError(hold.B, AsMatrix(golden_["R12_B"])), kGolden);
}

// P' = a^2 P with P the solution for (aA, aB, Q/rho, I), a = e^(alpha Ts)
// (docs/theory/control-law.md 6.3).
TEST_F(Golden, RiccatiSolutionAndGainAgree) {
  const double a = std::exp(3.0 * 0.02);
  const MatrixXd A = AsMatrix(golden_["R12_A"]), B = AsMatrix(golden_["R12_B"]);
  VectorXd weight = VectorXd::Zero(12);
  weight << 100, 20, 0, 0, 0, 0, 5, 1, 0, 0, 0, 0;
  const MatrixXd Q = weight.asDiagonal() * 0.5, R = MatrixXd::Identity(2, 2);
  const MatrixXd P = SolveDare(a * A, a * B, Q, R);
  EXPECT_LT(RelativeError(a * a * P, AsMatrix(golden_["R12_P"])), kGolden);
  // The gain divides by B'PB and loses two more digits: the bound for gains is 1e-6.
  EXPECT_LT(RelativeError(DareGain(a * A, a * B, R, P), AsMatrix(golden_["R12_K"])), 1e-6);
}

// States of an independent model (quadrature over every mass point) with I_r2 alone in link 1's tip
// and mass-normalised modal coordinates: phi_tip = phi_mass * psi_mass(L).
class Oracle : public testing::TestWithParam<std::size_t> {
 protected:
  Oracle() {
    for (const char* link : {"link1", "link2"}) {
      for (double psi : oracles_["modes"][link]["psi_tip"]) scale_.push_back(psi);
    }
  }

  static ArmParameters Parameters() {
    ArmParameters p = ThesisRig();
    p.link1_tip_inertia = Link1TipInertia::kMotor;
    return p;
  }

  VectorXd TipNormalised(VectorXd x) const {
    for (Eigen::Index i = 0; i < 4; ++i) x[kPhi1 + i] *= scale_[static_cast<std::size_t>(i)];
    return x;
  }

  // The work of a force on a coordinate is invariant, so it scales inversely.
  VectorXd MassNormalisedForce(VectorXd x) const { return TipNormalised(std::move(x)); }

  const nlohmann::json oracles_ = GoldenFile("oracles.json");
  const nlohmann::json state_ = oracles_["states"][GetParam()];
  const ArmModel arm_{Parameters(), {2, 2}};
  std::vector<double> scale_;
};

INSTANTIATE_TEST_SUITE_P(States, Oracle, testing::Values(0u, 1u));

TEST_P(Oracle, MassMatrixBiasAndSpringForcesAgree) {
  const VectorXd q = TipNormalised(AsVector(state_["q"])), v = TipNormalised(AsVector(state_["v"]));
  const VectorXd t = TipNormalised(VectorXd::Ones(8));
  const MatrixXd M = t.asDiagonal() * arm_.MassMatrix(q) * t.asDiagonal();
  EXPECT_LT(RelativeError(M, AsMatrix(state_["M"])), 1e-9);
  EXPECT_LT(RelativeError(MassNormalisedForce(arm_.Bias(q, v)), AsVector(state_["bias"])), 1e-9);
  EXPECT_LT(RelativeError(MassNormalisedForce(arm_.stiffness() * q), AsVector(state_["Kq"])), 1e-9);
}

TEST_P(Oracle, AccelerationsAgreeWithAndWithoutDamping) {
  const VectorXd q = TipNormalised(AsVector(state_["q"])), v = TipNormalised(AsVector(state_["v"]));
  const VectorXd force = arm_.InputMatrix() * AsVector(state_["tau"]);
  EXPECT_LT(RelativeError(arm_.Acceleration(q, v, force),
                          TipNormalised(AsVector(state_["qdd_damp_rho"]))),
            1e-9);
  EXPECT_LT(RelativeError(arm_.Acceleration(q, v, force + arm_.damping() * v),
                          TipNormalised(AsVector(state_["qdd_nodamp"]))),
            1e-9);
}

TEST_P(Oracle, EnergiesAndTipAgree) {
  const VectorXd q = TipNormalised(AsVector(state_["q"])), v = TipNormalised(AsVector(state_["v"]));
  const double T = state_["T"], U = state_["U"];
  EXPECT_NEAR(arm_.KineticEnergy(q, v), T, 1e-9 * T);
  EXPECT_NEAR(arm_.PotentialEnergy(q), U, 1e-9 * U);
  EXPECT_LT(RelativeError(arm_.TipPosition(q), AsVector(state_["tip"])), 1e-9);
  EXPECT_LT(RelativeError(arm_.TipVelocity(q, v), AsVector(state_["tip_vel"])), 1e-9);
}

}  // namespace
}  // namespace flexarm
