#include "model/math/invariant_zeros.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Companion form of the denominator s^n + a_1 s^(n-1) + .., output the numerator b_0 + b_1 s + ..
struct TransferFunction {
  MatrixXd A, B, C;

  TransferFunction(const std::vector<double>& a, const std::vector<double>& b)
      : A(MatrixXd::Zero(Size(a), Size(a))),
        B(MatrixXd::Zero(Size(a), 1)),
        C(MatrixXd::Zero(1, Size(a))) {
    const Eigen::Index n = Size(a);
    A.topRightCorner(n - 1, n - 1).setIdentity();
    for (Eigen::Index i = 0; i < n; ++i) A(n - 1, i) = -a[static_cast<std::size_t>(n - 1 - i)];
    B(n - 1, 0) = 1.0;
    for (std::size_t i = 0; i < b.size(); ++i) C(0, static_cast<Eigen::Index>(i)) = b[i];
  }

  static Eigen::Index Size(const std::vector<double>& a) {
    return static_cast<Eigen::Index>(a.size());
  }
};

std::vector<double> SortedReals(const Eigen::VectorXcd& zeros) {
  std::vector<double> real;
  for (const std::complex<double>& zero : zeros) {
    EXPECT_NEAR(zero.imag(), 0.0, 1e-9);
    real.push_back(zero.real());
  }
  std::sort(real.begin(), real.end());
  return real;
}

// (s - 3)(s + 7) over a polynomial of degree 2 + k: relative degrees 1 to 3.
TEST(InvariantZeros, AreTheRootsOfTheNumerator) {
  for (const std::vector<double>& denominator : {std::vector<double>{6.0, 11.0, 6.0},
                                                 {10.0, 35.0, 50.0, 24.0},
                                                 {15.0, 85.0, 225.0, 274.0, 120.0}}) {
    const TransferFunction system(denominator, {-21.0, 4.0, 1.0});
    const auto zeros = SortedReals(InvariantZeros(system.A, system.B, system.C));
    ASSERT_EQ(zeros.size(), 2U);
    EXPECT_NEAR(zeros[0], -7.0, 1e-9);
    EXPECT_NEAR(zeros[1], 3.0, 1e-9);
  }
}

TEST(InvariantZeros, AreNoneForAChainOfIntegrators) {
  const TransferFunction system({0.0, 0.0, 0.0, 0.0}, {1.0});
  EXPECT_EQ(InvariantZeros(system.A, system.B, system.C).size(), 0);
}

// A force on a first mass, m x1'' = u - k (x1 - x2), M x2'' = k (x1 - x2). To x1: +-i sqrt(k / M).
// To x2: none. To x1 - e x2 (a beam's end has e > 1): M s^2 + k = e k, so +-sqrt((e - 1) k / M).
TEST(InvariantZeros, OfTwoMassesFollowFromTheOutput) {
  const double m = 1.0, M = 0.5, k = 200.0, e = 3.0;
  MatrixXd A = MatrixXd::Zero(4, 4), B = MatrixXd::Zero(4, 1), C = MatrixXd::Zero(1, 4);
  A.topRightCorner(2, 2).setIdentity();
  A.bottomLeftCorner(2, 2) << -k / m, k / m, k / M, -k / M;
  B(2, 0) = 1.0 / m;
  C(0, 0) = 1.0;
  const Eigen::VectorXcd colocated = InvariantZeros(A, B, C);
  ASSERT_EQ(colocated.size(), 2);
  EXPECT_NEAR(std::abs(colocated[0].imag()), std::sqrt(k / M), 1e-9);
  EXPECT_NEAR(colocated[0].real(), 0.0, 1e-9);
  C << 0.0, 1.0, 0.0, 0.0;
  EXPECT_EQ(InvariantZeros(A, B, C).size(), 0);
  C << 1.0, -e, 0.0, 0.0;
  const auto end = SortedReals(InvariantZeros(A, B, C));
  ASSERT_EQ(end.size(), 2U);
  // M s^2 + k - e k = 0
  EXPECT_NEAR(end[1], std::sqrt((e - 1.0) * k / M), 1e-9);
  EXPECT_NEAR(end[0], -end[1], 1e-9);
}

TEST(InvariantZeros, RefuseASystemThatIsNotInvertibleAndSizesThatDoNotFit) {
  MatrixXd A = MatrixXd::Identity(3, 3), B(3, 2), C(2, 3);
  B << 1.0, 0.0, 0.0, 1.0, 0.0, 0.0;
  C << 1.0, 1.0, 0.0, 2.0, 2.0, 0.0;
  EXPECT_THROW(InvariantZeros(A, B, C), std::invalid_argument);
  EXPECT_THROW(InvariantZeros(A, B, C.topRows(1)), std::invalid_argument);
}

TEST(CountIntegrators, TellsPolesFromChains) {
  MatrixXd A = MatrixXd::Zero(5, 5);
  A(0, 1) = 1.0;   // two integrators in series
  A(2, 2) = -3.0;  // and one alone, beside two stable poles
  A(3, 3) = -4.0;
  Integrators found = CountIntegrators(A);
  EXPECT_EQ(found.poles, 3);
  EXPECT_EQ(found.chains, 2);
  found = CountIntegrators(A + MatrixXd::Identity(5, 5), 1.0);
  EXPECT_EQ(found.poles, 3);
  EXPECT_EQ(CountIntegrators(-MatrixXd::Identity(4, 4)).poles, 0);
}

TEST(NumericalRank, IgnoresRoundOff) {
  MatrixXd A(3, 3);
  A << 1.0, 2.0, 3.0, 2.0, 4.0, 6.0 + 1e-14, 1.0, 0.0, 1.0;
  EXPECT_EQ(NumericalRank(A), 2);
  EXPECT_EQ(NumericalRank(MatrixXd::Identity(4, 4)), 4);
}

}  // namespace
}  // namespace flexarm
