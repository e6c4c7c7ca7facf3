#include "model/math/discretize.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace flexarm {
namespace {

using Eigen::MatrixXd;

// A sampled double integrator is exact: [[1, T], [0, 1]], [T^2/2, T].
TEST(ZeroOrderHold, DoubleIntegratorIsExact) {
  MatrixXd A(2, 2), B(2, 1);
  A << 0.0, 1.0, 0.0, 0.0;
  B << 0.0, 1.0;
  const DiscreteModel d = ZeroOrderHold(A, B, 0.02);
  EXPECT_NEAR(d.A(0, 1), 0.02, 1e-17);
  EXPECT_NEAR(d.B(0, 0), 2e-4, 1e-19);
  EXPECT_NEAR(d.B(1, 0), 0.02, 1e-17);
}

// An oscillator rotates: cos and sin of w T. Period 0.3 s and 250 rad/s make 12 full turns, so
// the exponential must scale and square; 1e-12 is round-off after about seven squarings.
TEST(ZeroOrderHold, OscillatorRotatesByItsAngle) {
  const double w = 250.0, T = 0.3;
  MatrixXd A(2, 2), B(2, 1);
  A << 0.0, 1.0, -w * w, 0.0;
  B << 0.0, 1.0;
  const DiscreteModel d = ZeroOrderHold(A, B, T);
  EXPECT_NEAR(d.A(0, 0), std::cos(w * T), 1e-12);
  EXPECT_NEAR(d.A(0, 1) * w, std::sin(w * T), 1e-12);
  EXPECT_NEAR(d.B(0, 0) * w * w, 1.0 - std::cos(w * T), 1e-12);
}

// Mixed units must lose no digits: scaling a state by 1e6 only scales the result.
TEST(MatrixExponential, UnitsOfTheStatesDoNotMatter) {
  MatrixXd A(3, 3);
  A << -1.0, 0.3, 0.2, 0.5, -2.0, 0.1, 0.0, 0.7, -0.5;
  const Eigen::Vector3d t(1.0, 1048576.0, 1.0 / 1048576.0);
  const MatrixXd scaled = t.asDiagonal() * A * t.cwiseInverse().asDiagonal();
  const MatrixXd back = t.cwiseInverse().asDiagonal() * MatrixExponential(scaled) * t.asDiagonal();
  EXPECT_LT((back - MatrixExponential(A)).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(ZeroOrderHold, WrongSizesAndPeriodsAreRejected) {
  const MatrixXd A = MatrixXd::Zero(2, 2), B = MatrixXd::Zero(2, 1);
  EXPECT_THROW(ZeroOrderHold(A, B, 0.0), std::invalid_argument);
  EXPECT_THROW(ZeroOrderHold(A, MatrixXd::Zero(3, 1), 0.1), std::invalid_argument);
  EXPECT_THROW(ZeroOrderHold(MatrixXd::Zero(2, 3), B, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
