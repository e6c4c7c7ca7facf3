#include "model/math/discretize.h"

#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "model/math/dense_decompositions.h"
#include "model/math/matrix_scaling.h"

namespace flexarm {
Eigen::MatrixXd MatrixExponential(const Eigen::MatrixXd& A) {
  const Eigen::VectorXd t = BalancingScale(A);
  const Eigen::MatrixXd balanced = t.cwiseInverse().asDiagonal() * A * t.asDiagonal();
  const Eigen::MatrixXd exponential = balanced.exp();
  return t.asDiagonal() * exponential * t.cwiseInverse().asDiagonal();
}

DiscreteModel ZeroOrderHold(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double period_s) {
  if (A.rows() != A.cols() || B.rows() != A.rows() || !(period_s > 0.0)) {
    throw std::invalid_argument("ZeroOrderHold: A must be square, B as tall, the period positive");
  }
  const Eigen::Index n = A.rows(), m = B.cols();
  Eigen::MatrixXd augmented = Eigen::MatrixXd::Zero(n + m, n + m);
  augmented.topLeftCorner(n, n) = A * period_s;
  augmented.topRightCorner(n, m) = B * period_s;
  const Eigen::MatrixXd exponential = MatrixExponential(augmented);
  return {exponential.topLeftCorner(n, n), exponential.topRightCorner(n, m)};
}

}  // namespace flexarm
