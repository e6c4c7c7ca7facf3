// The Kalman filter on the linear model with the noises that it was designed for: its innovations
// must be white, of zero mean, and of the predicted covariance.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "estimator/state_estimator.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "tests/estimator/thesis_estimator.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kInnovations = 4000, kSettled = 200, kOutputs = 8, kStates = 16;

// Continuous model with the gauge filter, written independently: phi_f' = w_f (phi - phi_f).
struct Truth {
  MatrixXd A, G_d, C, R;

  Truth() {
    const NominalModel nominal = MakeNominalModel(ThesisRig(), kR12);
    const double w_f = 2.0 * std::numbers::pi * 20.0;
    MatrixXd A_c = MatrixXd::Zero(kStates, kStates), G_c = MatrixXd::Zero(kStates, 6);
    A_c.topLeftCorner(12, 12) = nominal.A;
    for (int i = 0; i < 4; ++i) {
      A_c(12 + i, 2 + i) = w_f;
      A_c(12 + i, 12 + i) = -w_f;
    }
    G_c.middleRows(6, 6) = nominal.M.inverse();
    const DiscreteModel discrete = ZeroOrderHold(A_c, G_c, kPeriod_s);
    A = discrete.A;
    VectorXd sigma(6);
    sigma << 0.3, 0.05, 5.0, 5.0, 1.5, 1.5;
    G_d = discrete.B * sigma.asDiagonal();
    C = MatrixXd::Zero(kOutputs, kStates);
    C(0, 0) = C(1, 1) = C(2, 0) = C(3, 1) = 1.0;
    for (int i = 0; i < 4; ++i) C(4 + i, 12 + i) = 1.0;
    const double q = 2.0 * std::numbers::pi / 2540.0, fine = 2.0 * std::numbers::pi / 24480.0;
    VectorXd variance(kOutputs);
    variance << q * q / 12, q * q / 12, q * q / 12 + 9e-8, fine * fine / 12 + 9e-8, 4e-8, 1e-8,
        4e-8, 1e-8;
    R = variance.asDiagonal();
  }

  // Covariance of the innovations of the optimal filter, by iterating its covariance recursion.
  MatrixXd InnovationCovariance() const {
    const MatrixXd W = G_d * G_d.transpose() + 1e-13 * MatrixXd::Identity(kStates, kStates);
    MatrixXd P = W, S;
    for (int k = 0; k < 4000; ++k) {
      S = C * P * C.transpose() + R;
      const MatrixXd L = S.llt().solve(C * P).transpose();
      P = A * (P - L * C * P) * A.transpose() + W;
    }
    return S;
  }
};

std::vector<VectorXd> Innovations(const Truth& truth) {
  const KalmanDesign design = ThesisFilter();
  StateEstimator estimator(ThesisEstimator(),
                           {.layout = kR12,
                            .A = design.A,
                            .B = design.B,
                            .C = design.C,
                            .L = design.L,
                            .A_rate = design.A_rate,
                            .B_rate = design.B_rate,
                            .W = design.W,
                            .P = design.P,
                            .R = design.R},
                           kPeriod_s, kStiffness);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  VectorXd x = VectorXd::Zero(kStates);
  std::vector<VectorXd> out;
  for (int k = 0; k < kInnovations + kSettled; ++k) {
    VectorXd y = truth.C * x;
    for (int i = 0; i < kOutputs; ++i) y(i) += std::sqrt(truth.R(i, i)) * normal(random);
    DecodedCounters counters{};
    counters.angle_rad = {y(0), y(1), y(2), y(3)};
    counters.good = 0b1111;
    FittedModes modes{};
    modes.modal_m = {y(4), y(5), y(6), y(7)};
    modes.valid = {true, true};
    const auto estimate = estimator.Update(counters, modes, {0.0, 0.0});
    if (k >= kSettled) {
      out.push_back(Eigen::Map<const VectorXd>(estimate.innovation.data(), kOutputs));
    }
    VectorXd force(6);
    for (int i = 0; i < 6; ++i) force(i) = normal(random);
    x = truth.A * x + truth.G_d * force;
  }
  return out;
}

class InnovationsTest : public testing::Test {
 protected:
  const Truth truth_;
  const MatrixXd S_ = truth_.InnovationCovariance();
  const std::vector<VectorXd> innovation_ = Innovations(truth_);
};

// The sum of v' S^-1 v over N samples is chi-square with 8 N degrees of freedom: the mean lies in
// 8 +- 4 sqrt(16 / N) with 4 sigma.
TEST_F(InnovationsTest, NormalisedSquareLiesInsideItsChiSquareBounds) {
  const Eigen::LLT<MatrixXd> S(S_);
  double sum = 0.0;
  for (const VectorXd& v : innovation_) sum += v.dot(S.solve(v));
  EXPECT_NEAR(sum / kInnovations, 8.0, 4.0 * std::sqrt(16.0 / kInnovations));
}

// Each output's mean, and its correlation with every output one and two samples earlier: standard
// error 1 / sqrt(N), 4.5 of them for 8 + 128 comparisons.
TEST_F(InnovationsTest, AreWhiteAndOfZeroMean) {
  const double bound = 4.5 / std::sqrt(kInnovations);
  for (int i = 0; i < kOutputs; ++i) {
    double mean = 0.0;
    for (const VectorXd& v : innovation_) mean += v(i) / kInnovations;
    EXPECT_LT(std::abs(mean), bound * std::sqrt(S_(i, i))) << "output " << i;
    for (int j = 0; j < kOutputs; ++j) {
      for (const std::size_t lag : {std::size_t{1}, std::size_t{2}}) {
        double correlation = 0.0;
        for (std::size_t k = lag; k < innovation_.size(); ++k) {
          correlation += innovation_[k](i) * innovation_[k - lag](j) / kInnovations;
        }
        EXPECT_LT(std::abs(correlation), bound * std::sqrt(S_(i, i) * S_(j, j)))
            << "outputs " << i << " and " << j << ", lag " << lag;
      }
    }
  }
}

}  // namespace
}  // namespace flexarm
