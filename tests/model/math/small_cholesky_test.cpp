#include "model/math/small_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace flexarm {
namespace {

template <int Rows, int Columns>
using FixedMatrix = Eigen::Matrix<double, Rows, Columns>;

// Cases of the arm: sizes on both sides of a panel's four columns, and several panels.
template <int N>
void ExpectBitsOfEigen() {
  SCOPED_TRACE(N);
  srand(17);  // Eigen's Random
  for (int sample = 0; sample < 200; ++sample) {
    const FixedMatrix<N, N> R = FixedMatrix<N, N>::Random(), I = FixedMatrix<N, N>::Identity();
    const FixedMatrix<N, N> A = R * R.transpose() + 0.1 * I;
    const FixedMatrix<N, 3> B = FixedMatrix<N, 3>::Random();
    const Eigen::LLT<FixedMatrix<N, N>> eigen(A);
    const SmallCholesky<N> small(A.template triangularView<Eigen::Lower>().toDenseMatrix());

    const FixedMatrix<N, N> L = eigen.matrixL();
    const FixedMatrix<N, N> small_L = small.L().template triangularView<Eigen::Lower>();
    ASSERT_EQ(small_L, L);
    FixedMatrix<N, 3> X = B, Y = B;
    eigen.matrixL().solveInPlace(X);
    small.SolveLower(&Y);
    ASSERT_EQ(Y, X);
    X = eigen.solve(B);
    ASSERT_EQ(small.Solve(B), X);
    FixedMatrix<N, N> inverse = eigen.solve(I);
    ASSERT_EQ(small.Solve(I), inverse);
    if constexpr (N <= 4) {
      const FixedMatrix<N, 1> b = FixedMatrix<N, 1>::Random(), x = eigen.solve(b);
      ASSERT_EQ(small.Solve(b), x);
    }
  }
}

// Reference: Eigen. Where it has a fused multiply-add it rounds once less often.
TEST(SmallCholesky, IsBitIdenticalToEigensGeneralAlgorithm) {
#if defined(EIGEN_VECTORIZE_FMA) || defined(__ARM_FEATURE_FMA)
  GTEST_SKIP() << "Eigen uses fused multiply-add on this processor";
#endif
  ExpectBitsOfEigen<2>();
  ExpectBitsOfEigen<3>();
  ExpectBitsOfEigen<4>();
  ExpectBitsOfEigen<5>();
  ExpectBitsOfEigen<9>();
  ExpectBitsOfEigen<13>();
}

TEST(SmallCholesky, SolvesAKnownSystem) {
  // L = [2 0; 1 3]: A = [4 2; 2 10]; A [1; 1] = [6; 12]
  const SmallCholesky<2> small(Eigen::Matrix2d{{4.0, 2.0}, {2.0, 10.0}});
  EXPECT_EQ(small.L()(0, 0), 2.0);
  EXPECT_EQ(small.L()(1, 0), 1.0);
  EXPECT_EQ(small.L()(1, 1), 3.0);
  EXPECT_EQ(small.Solve(Eigen::Vector2d(6.0, 12.0)), Eigen::Vector2d(1.0, 1.0));
}

TEST(SmallCholesky, GivesNanForAMatrixThatIsNotPositiveDefinite) {
  const SmallCholesky<2> small(Eigen::Matrix2d{{1.0, 2.0}, {2.0, 1.0}});
  EXPECT_TRUE(std::isnan(small.Solve(Eigen::Vector2d(1.0, 1.0))[1]));
}

}  // namespace
}  // namespace flexarm
