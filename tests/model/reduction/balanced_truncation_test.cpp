#include "model/reduction/balanced_truncation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/reduction/arm_reduction.h"
#include "tests/support/thesis_rig.h"

extern "C" void ab09md_(const char* dico, const char* job, const char* equil, const char* ordsel,
                        const int* n, const int* m, const int* p, int* nr, const double* alpha,
                        double* a, const int* lda, double* b, const int* ldb, double* c,
                        const int* ldc, int* ns, double* hsv, const double* tol, int* iwork,
                        double* dwork, const int* ldwork, int* iwarn, int* info, std::size_t,
                        std::size_t, std::size_t, std::size_t);

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// SLICOT: real Schur forms, different swaps and Lyapunov solver.
struct SlicotReduction {
  VectorXd hankel;
  StateSpace reduced;
};

SlicotReduction Slicot(StateSpace s, double alpha, int order) {
  const int n = static_cast<int>(s.A.rows()), m = static_cast<int>(s.B.cols()),
            p = static_cast<int>(s.C.rows()), work = 64 * (n + 16) * (n + m + p + 16);
  int nr = order, ns = 0, warn = 0, info = 0;
  const double tol = 0.0;
  std::vector<int> iwork(static_cast<std::size_t>(n));
  std::vector<double> dwork(static_cast<std::size_t>(work));
  VectorXd hankel(n);
  ab09md_("C", "B", "S", "F", &n, &m, &p, &nr, &alpha, s.A.data(), &n, s.B.data(), &n, s.C.data(),
          &p, &ns, hankel.data(), &tol, iwork.data(), dwork.data(), &work, &warn, &info, 1, 1, 1,
          1);
  if (info != 0) throw std::runtime_error("ab09md: info = " + std::to_string(info));
  return {hankel.head(ns), {s.A.topLeftCorner(nr, nr), s.B.topRows(nr), s.C.leftCols(nr)}};
}

StateSpace RandomSystem(unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  const Index n = 3 + static_cast<Index>(seed % 9), m = 1 + static_cast<Index>(seed % 3);
  const auto matrix = [&](Index rows, Index cols) {
    MatrixXd out(rows, cols);
    for (double& x : out.reshaped()) x = normal(engine);
    return out;
  };
  MatrixXd A = matrix(n, n);
  if (seed % 2 == 0) A -= (A.eigenvalues().real().maxCoeff() + 0.1) * MatrixXd::Identity(n, n);
  return {A, matrix(n, m), matrix(2, n)};
}

TEST(GramianFactor, SolvesTheLyapunovEquation) {
  for (unsigned seed = 2; seed <= 60; seed += 2) {
    const StateSpace s = RandomSystem(seed);
    const MatrixXd F = GramianFactor(s.A, s.B), P = F * F.transpose();
    const MatrixXd left = s.A * P + P * s.A.transpose() + s.B * s.B.transpose();
    EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-11 * (1.0 + P.cwiseAbs().maxCoeff()))
        << "seed " << seed;
  }
  const MatrixXd one = MatrixXd::Identity(1, 1);
  EXPECT_THROW(GramianFactor(one, one), std::invalid_argument);
}

// x' = -a x + b u, y = c x: the one Hankel value is |b c| / (2 a).
TEST(BalancedTruncation, OneStateAgreesWithTheClosedForm) {
  const MatrixXd one = MatrixXd::Identity(1, 1);
  const BalancedSystem b = BalanceGramians({-4.0 * one, 3.0 * one, -2.0 * one}, 1e-3);
  ASSERT_EQ(b.hankel.size(), 1);
  EXPECT_NEAR(b.hankel[0], 6.0 / 8.0, 1e-15);
  EXPECT_NEAR(ErrorBound(b, 0), 1.5, 1e-15);
  EXPECT_NEAR(Gain(Truncated(b, 1), 0.0), 1.5, 1e-14);
  EXPECT_EQ(b.rest_states(), 0);
}

TEST(BalancedTruncation, AgreesWithSlicotOnRandomSystemsStableOrNot) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const StateSpace s = RandomSystem(seed);
    const BalancedSystem balanced = BalanceGramians(s, 1e-3);
    const int rest = balanced.rest_states();
    const int order = (static_cast<int>(balanced.hankel.size()) + 1) / 2;
    const SlicotReduction slicot = Slicot(s, -1e-3, rest + order);
    ASSERT_EQ(balanced.hankel.size(), slicot.hankel.size()) << "seed " << seed;
    if (balanced.hankel.size() == 0) continue;
    // Relative to the largest: the accuracy of SLICOT's own solver.
    EXPECT_LT((balanced.hankel - slicot.hankel).cwiseAbs().maxCoeff(), 1e-8 * slicot.hankel[0])
        << "seed " << seed;
    const StateSpace reduced = Truncated(balanced, order);
    for (const double omega : {0.0, 0.3, 2.0, 20.0}) {
      EXPECT_LT(GainOfDifference(reduced, slicot.reduced, omega),
                1e-7 * (1.0 + Gain(slicot.reduced, omega)))
          << "seed " << seed;
    }
  }
}

StateSpace Arm(int modes) {
  const ArmModel arm(ThesisRig(), {modes, modes});
  return DampedArm(arm, {0.5, 0.0, 0.0});
}

// Rigid-body motions are two Jordan blocks at zero: four states that no truncation changes.
TEST(BalancedTruncation, ArmAgreesWithSlicotAndKeepsItsRigidBody) {
  const StateSpace s = Arm(4);
  const BalancedSystem balanced = BalanceGramians(s, 1e-2);
  EXPECT_EQ(balanced.rest_states(), 4);
  EXPECT_LT(balanced.rest.A.eigenvalues().cwiseAbs().maxCoeff(), 1e-4);
  const SlicotReduction slicot = Slicot(s, -1e-2, 10);
  for (Index i = 0; i < 8; ++i) EXPECT_NEAR(slicot.hankel[i] / balanced.hankel[i], 1.0, 1e-6) << i;
  // At zero frequency the rigid body's gain is infinite; from 1 rad/s on, both are accurate to 1e-8
  // of the flexible part's largest value.
  const StateSpace reduced = Truncated(balanced, 6);
  for (const double omega : {1.0, 10.0, 41.0, 55.0, 105.0, 1000.0}) {
    EXPECT_LT(GainOfDifference(reduced, slicot.reduced, omega), 1e-6 * Gain(s, omega)) << omega;
  }
}

// Glover's and Enns's bound, at 1400 frequencies, at every order, including the rigid body.
TEST(BalancedTruncation, ErrorOfTheArmStaysBelowItsBoundAtEveryFrequency) {
  const StateSpace s = Arm(4);
  const BalancedSystem balanced = BalanceGramians(s, 1e-2);
  for (int order = 0; order < 12; ++order) {
    const StateSpace reduced = Truncated(balanced, order);
    const double bound = ErrorBound(balanced, order);
    double worst = 0.0;
    for (double omega = 1.0; omega < 1e6; omega *= 1.01) {
      worst = std::fmax(worst, GainOfDifference(s, reduced, omega));
    }
    // Round-off where the rigid body's gain is 1/omega^2 / (0.1 kg m^2).
    EXPECT_LT(worst, bound + 1e-9) << "order " << order;
    EXPECT_GT(worst, 0.01 * bound) << "the error must come near the bound";
  }
}

TEST(BalancedTruncation, AllStatesReproduceTheWholeSystem) {
  const StateSpace s = RandomSystem(7);
  const BalancedSystem balanced = BalanceGramians(s, 1e-3);
  const StateSpace whole = Truncated(balanced, static_cast<int>(balanced.stable.A.rows()));
  for (const double omega : {0.1, 1.0, 10.0}) {
    EXPECT_LT(GainOfDifference(s, whole, omega), 1e-10 * Gain(s, omega));
  }
  EXPECT_THROW(Truncated(balanced, -1), std::invalid_argument);
  EXPECT_THROW(Truncated(balanced, 100), std::invalid_argument);
  EXPECT_THROW(BalanceGramians({s.A, s.B.topRows(1), s.C}, 1e-3), std::invalid_argument);
  EXPECT_THROW(BalanceGramians(s, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
