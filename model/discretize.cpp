#include "model/discretize.h"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

namespace flexarm {
namespace {

// Powers of two t that even out rows and columns of T^-1 A T (Parlett and Reinsch 1969).
Eigen::VectorXd BalancingScale(Eigen::MatrixXd A) {
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(A.rows());
  A.diagonal().setZero();
  for (int sweep = 0; sweep < 20; ++sweep) {
    bool changed = false;
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const double column = A.col(i).lpNorm<1>(), row = A.row(i).lpNorm<1>();
      if (column == 0.0 || row == 0.0) continue;
      const double f = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (f == 1.0) continue;
      A.col(i) *= f;
      A.row(i) /= f;
      scale[i] *= f;
      changed = true;
    }
    if (!changed) break;
  }
  return scale;
}

}  // namespace

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
