#include "estimator/fractional_zero_order_hold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "estimator/nominal_model.h"
#include "tests/support/loop_time.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using State = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 16, 1>;

// exp(M) by its own series, in extended precision: 30 terms of a matrix scaled below 1/16 leave
// 16^-30, then squaring. Independent of the Pade approximant that the product uses.
LongMatrix Exponential(LongMatrix M) {
  int squarings = 0;
  while (M.cwiseAbs().rowwise().sum().maxCoeff() > 0.0625L) {
    M *= 0.5L;
    ++squarings;
  }
  LongMatrix sum = LongMatrix::Identity(M.rows(), M.cols()), term = sum;
  for (int n = 1; n <= 30; ++n) {
    term = term * M / static_cast<long double>(n);
    sum += term;
  }
  for (int i = 0; i < squarings; ++i) sum = sum * sum;
  return sum;
}

class FractionalHoldTest : public testing::Test {
 protected:
  Eigen::VectorXd Exact(const Eigen::VectorXd& x, const TorquePiece& piece) const {
    const Eigen::Index n = nominal_.A.rows();
    const long double t_s = static_cast<long double>(kPeriod_s) * piece.ticks / kPeriodTicks;
    LongMatrix augmented = LongMatrix::Zero(n + 2, n + 2);
    augmented.topLeftCorner(n, n) = nominal_.A.cast<long double>() * t_s;
    augmented.topRightCorner(n, 2) = nominal_.B.cast<long double>() * t_s;
    LongMatrix start(n + 2, 1);
    start << x.cast<long double>(), piece.torque_nm[0], piece.torque_nm[1];
    const LongMatrix end = Exponential(augmented) * start;
    return end.topRows(n).cast<double>();
  }

  const NominalModel nominal_ = MakeNominalModel(ThesisRig(), kR12);
  const DiscreteModel whole_ = ZeroOrderHold(nominal_.A, nominal_.B, kPeriod_s);
  const FractionalZeroOrderHold hold_{whole_, nominal_.A, nominal_.B, kPeriod_s};
  State start_ = State::LinSpaced(12, 0.2, -0.1);
};

// Up to 17 products of matrices whose entries are rounded to 1e-16 of their largest, and whose
// states differ by the 100 1/s between an angle and its rate: 17 * 12 * 100 * 1e-16 = 2e-12.
TEST_F(FractionalHoldTest, IsTheExactHoldOfAnyFraction) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int64_t> ticks(1, 3 * kPeriodTicks);
  for (int i = 0; i < 50; ++i) {
    const TorquePiece piece{.torque_nm = {3.0, -0.7}, .ticks = ticks(random)};
    PiecewiseTorque pieces;
    pieces.Add(piece);
    State x = start_;
    hold_.Advance(pieces, &x);
    const Eigen::VectorXd expected = Exact(start_, piece);
    EXPECT_LT((x - expected).cwiseAbs().maxCoeff(), 2e-12 * expected.cwiseAbs().maxCoeff())
        << piece.ticks;
  }
}

TEST_F(FractionalHoldTest, AdvancesOverThePiecesInOrder) {
  PiecewiseTorque pieces;
  const TorquePiece first{.torque_nm = {3.0, -0.7}, .ticks = 20'000},
      second{.torque_nm = {-1.0, 0.4}, .ticks = 45'536};
  pieces.Add(first);
  pieces.Add(second);
  State x = start_;
  hold_.Advance(pieces, &x);
  const Eigen::VectorXd expected = Exact(Exact(start_, first), second);
  EXPECT_LT((x - expected).cwiseAbs().maxCoeff(), 2e-12 * expected.cwiseAbs().maxCoeff());
}

// A whole period does not use the digits: it is the hold of the design, to the bit.
TEST_F(FractionalHoldTest, AWholePeriodIsTheHoldOfTheDesign) {
  State x = start_;
  hold_.Advance(PiecewiseTorque::WholePeriod({3.0, -0.7}), &x);
  State expected = whole_.A.lazyProduct(start_);
  expected += whole_.B.col(0) * 3.0;
  expected += whole_.B.col(1) * -0.7;
  EXPECT_EQ(x, expected);
}

TEST_F(FractionalHoldTest, AnEmptyIntervalChangesNothing) {
  State x = start_;
  hold_.Advance(PiecewiseTorque(), &x);
  EXPECT_EQ(x, start_);
}

}  // namespace
}  // namespace flexarm
