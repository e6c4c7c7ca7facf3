#include "model/math/riccati.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "model/math/dense_decompositions.h"

extern "C" void sb02od_(const char* dico, const char* jobb, const char* fact, const char* uplo,
                        const char* jobl, const char* sort, const int* n, const int* m,
                        const int* p, const double* a, const int* lda, const double* b,
                        const int* ldb, const double* q, const int* ldq, const double* r,
                        const int* ldr, const double* l, const int* ldl, double* rcond, double* x,
                        const int* ldx, double* alfar, double* alfai, double* beta, double* s,
                        const int* lds, double* t, const int* ldt, double* u, const int* ldu,
                        const double* tol, int* iwork, double* dwork, const int* ldwork, int* bwork,
                        int* info, std::size_t, std::size_t, std::size_t, std::size_t, std::size_t,
                        std::size_t);

namespace flexarm {
namespace {

using Eigen::MatrixXd;

// SLICOT's generalised Schur method: independent of doubling.
MatrixXd SlicotDare(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R) {
  const int n = static_cast<int>(A.rows()), m = static_cast<int>(B.cols()), p = 0, one = 1;
  const int wide = 2 * n + m, two_n = 2 * n, work = 64 * (wide + 16);
  const auto doubles = [](int size) { return std::vector<double>(static_cast<std::size_t>(size)); };
  auto alfar = doubles(two_n), alfai = doubles(two_n), beta = doubles(two_n);
  auto S = doubles(wide * wide), T = doubles(wide * two_n), U = doubles(two_n * two_n);
  auto dwork = doubles(work);
  std::vector<int> iwork(static_cast<std::size_t>(wide)), bwork(static_cast<std::size_t>(two_n));
  MatrixXd X(n, n);
  double rcond = 0.0;
  const double tol = 0.0, L = 0.0;
  int info = 0;
  sb02od_("D", "B", "N", "U", "Z", "S", &n, &m, &p, A.data(), &n, B.data(), &n, Q.data(), &n,
          R.data(), &m, &L, &one, &rcond, X.data(), &n, alfar.data(), alfai.data(), beta.data(),
          S.data(), &wide, T.data(), &wide, U.data(), &two_n, &tol, iwork.data(), dwork.data(),
          &work, bwork.data(), &info, 1, 1, 1, 1, 1, 1);
  if (info != 0) throw std::runtime_error("sb02od: info = " + std::to_string(info));
  return X;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  MatrixXd Matrix(int rows, int cols) {
    MatrixXd out(rows, cols);
    for (double& x : out.reshaped()) x = normal_(engine_);
    return out;
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

// 60 random systems of 1 to 16 states, half of them unstable, with rank-deficient Q. The two
// methods agree to round-off times the condition of the problem: 1e-12 typical, 1e-8 allows
// for the worst. Any wrong term gives a quite different matrix.
TEST(SolveDare, AgreesWithSlicotOnRandomSystems) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const int n = 1 + static_cast<int>(seed % 16), m = 1 + static_cast<int>(seed % 3);
    MatrixXd A = random.Matrix(n, n);
    A *= (seed % 2 == 0 ? 0.9 : 1.5) / A.eigenvalues().cwiseAbs().maxCoeff();
    const MatrixXd B = random.Matrix(n, m), C = random.Matrix((n + 1) / 2, n);
    const MatrixXd Q = C.transpose() * C, r = random.Matrix(m, m);
    const MatrixXd R = r * r.transpose() + MatrixXd::Identity(m, m);
    const MatrixXd P = SolveDare(A, B, Q, R), expected = SlicotDare(A, B, Q, R);
    EXPECT_LT((P - expected).cwiseAbs().maxCoeff(), 1e-8 * expected.cwiseAbs().maxCoeff())
        << "seed " << seed;
    EXPECT_LT(DareResidual(A, B, Q, R, P), 1e-10) << "seed " << seed;
    EXPECT_EQ(P, P.transpose());
    const MatrixXd F = A - B * DareGain(A, B, R, P);
    EXPECT_LT(F.eigenvalues().cwiseAbs().maxCoeff(), 1.0) << "seed " << seed;
  }
}

// Two integrators in series (eigenvalues on the circle) are allowed if Q weights them.
TEST(SolveDare, DoubleIntegratorHasAStabilisingSolution) {
  MatrixXd A(2, 2), B(2, 1);
  A << 1.0, 0.02, 0.0, 1.0;
  B << 2e-4, 0.02;
  const MatrixXd Q = Eigen::Vector2d(1.0, 0.0).asDiagonal(), R = MatrixXd::Identity(1, 1);
  const MatrixXd P = SolveDare(A, B, Q, R);
  EXPECT_LT((P - SlicotDare(A, B, Q, R)).cwiseAbs().maxCoeff(), 1e-9 * P.maxCoeff());
}

TEST(SolveDare, ProblemsWithoutSolutionAreRejected) {
  const MatrixXd one = MatrixXd::Identity(1, 1), zero = MatrixXd::Zero(1, 1);
  EXPECT_THROW(SolveDare(2.0 * one, zero, one, one), std::runtime_error) << "not stabilisable";
  EXPECT_THROW(SolveDare(one, one, zero, one), std::runtime_error)
      << "integrator not weighted by Q";
  EXPECT_THROW(SolveDare(one, one, one, -one), std::invalid_argument);
  EXPECT_THROW(SolveDare(one, MatrixXd::Zero(2, 1), one, one), std::invalid_argument);
}

TEST(SolveStein, ResidualIsRoundOffOnRandomProblems) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const int n = 1 + static_cast<int>(seed % 12), m = 1 + static_cast<int>(seed % 7);
    const MatrixXd A = random.Matrix(n, n), B = random.Matrix(m, m), C = random.Matrix(n, m);
    const MatrixXd X = SolveStein(A, B, C);
    // Random products may be near 1 and make X large: relative to X.
    EXPECT_LT((X - A * X * B - C).cwiseAbs().maxCoeff(), 1e-11 * (1.0 + X.cwiseAbs().maxCoeff()))
        << "seed " << seed;
  }
}

// As the command generator tracker needs it: B has eigenvalues exactly on the unit circle (and a
// Jordan block), A outside and inside; only products equal to 1 are forbidden.
TEST(SolveStein, EigenvaluesOnTheUnitCircleAreAllowed) {
  MatrixXd A(3, 3), B(3, 3);
  A << 1.7, 0.3, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, -2.0;
  B << 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0;
  const MatrixXd C = Random(7).Matrix(3, 3), X = SolveStein(A, B, C);
  EXPECT_LT((X - A * X * B - C).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(SolveStein, ReciprocalEigenvaluesAreRejected) {
  const MatrixXd A = Eigen::Vector2d(2.0, 0.3).asDiagonal(), B = 0.5 * MatrixXd::Identity(1, 1);
  EXPECT_THROW(SolveStein(A, B, MatrixXd::Ones(2, 1)), std::runtime_error);
  EXPECT_THROW(SolveStein(A, B, MatrixXd::Ones(1, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
