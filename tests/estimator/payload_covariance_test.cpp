// Against the same formulas by products of whole matrices, on random covariances.

#include "estimator/payload_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "tests/support/no_alloc.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Matrix = PayloadCovariance::Matrix;
using Vector = PayloadCovariance::Vector;

constexpr int kStates = PayloadCovariance::kStates, kMotion = PayloadCovariance::kMotion;
constexpr int kOutputs = 8;

// Entries of the order of one: the tolerances are those of sums of 19 products.
class RandomCovariance : public testing::Test {
 protected:
  MatrixXd Random(int rows, int columns) {
    return MatrixXd::NullaryExpr(rows, columns, [this] { return normal_(engine_); });
  }

  Matrix RandomP() {
    const MatrixXd root = Random(kStates, kStates + 4) / 5.0;
    Matrix P = Matrix::Zero();
    P.topLeftCorner<kStates, kStates>() = root * root.transpose();
    return P;
  }

  static void ExpectEqual(const Matrix& P, const MatrixXd& expected) {
    EXPECT_LT((P.topLeftCorner<kStates, kStates>() - expected).norm(), 1e-13 * expected.norm());
    EXPECT_EQ(P, P.transpose()) << "to the bit";
    EXPECT_EQ(P.row(kStates).norm(), 0.0);
  }

 private:
  std::mt19937_64 engine_{1};
  std::normal_distribution<double> normal_;
};

class Frozen : public RandomCovariance, public testing::WithParamInterface<int> {};

TEST_F(RandomCovariance, PropagatesAsTheWholeMatrices) {
  PayloadCovariance::Change change;
  change.by_driving = Random(kMotion, 15);
  change.gauge_kept = 0.7;
  const MatrixXd N = Random(kMotion, 6);
  MatrixXd F = MatrixXd::Identity(kStates, kStates), NN = MatrixXd::Zero(kStates, kStates);
  F.topLeftCorner(kMotion, 12) = change.by_driving.leftCols<12>();
  F.topRightCorner(kMotion, 3) = change.by_driving.rightCols<3>();
  F.block(12, 12, 4, 4) = 0.7 * MatrixXd::Identity(4, 4);
  NN.topLeftCorner(kMotion, kMotion) = N * N.transpose();

  Matrix P = RandomP();
  const MatrixXd expected = F * P.topLeftCorner<kStates, kStates>() * F.transpose() + NN;
  {
    const NoAlloc armed;
    PayloadCovariance::Propagate(change, Eigen::Matrix<double, kMotion, 6>(N), &P);
  }
  ExpectEqual(P, expected);

  Vector dx = Vector::Zero();
  dx.head<kStates>() = Random(kStates, 1);
  EXPECT_LT((change.Of(dx).head<kStates>() - F * dx.head<kStates>()).norm(), 1e-13 * dx.norm());
}

// P <- (I - K H) P (I - K H)' + K R K', which holds for any gain K: here the optimal one with rows
// of zeros.
TEST_P(Frozen, ReducesAsJosephsForm) {
  const int frozen = GetParam();
  for (int round = 0; round < 20; ++round) {
    Matrix P = RandomP();
    const MatrixXd before = P.topLeftCorner<kStates, kStates>();
    const MatrixXd H = Random(kOutputs, kStates), R = 0.1 * MatrixXd::Identity(kOutputs, kOutputs);
    const MatrixXd S = H * before * H.transpose() + R;
    MatrixXd K = before * H.transpose() * S.inverse();
    K.bottomRows(3).topRows(frozen).setZero();
    const MatrixXd J = MatrixXd::Identity(kStates, kStates) - K * H;
    const MatrixXd expected = J * before * J.transpose() + K * R * K.transpose();

    const MatrixXd L = S.llt().matrixL();
    PayloadCovariance::ByOutput<kOutputs> V = PayloadCovariance::ByOutput<kOutputs>::Zero();
    V.topRows<kStates>() = L.triangularView<Eigen::Lower>().solve(H * before).transpose();
    PayloadCovariance::Reduce(V, frozen, &P);
    // The gain is a quotient of sums of some hundred products.
    EXPECT_LT((P.topLeftCorner<kStates, kStates>() - expected).norm(), 1e-11 * before.norm());
    EXPECT_EQ(P, P.transpose()) << "to the bit";
    EXPECT_GT(
        P.topLeftCorner(kStates, kStates).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(),
        0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(States, Frozen, testing::Values(0, 1, 3));

}  // namespace
}  // namespace flexarm
