#include "model/math/invariant_zeros.h"

#include <algorithm>
#include <stdexcept>

#include "model/math/dense_decompositions.h"
#include "model/math/matrix_scaling.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kZeroTolerance = 1e-9;

Index RankOf(const VectorXd& singular, double largest) {
  return (singular.array() > kZeroTolerance * largest).count();
}

// Orthonormal basis of the null space of X; entries below kZeroTolerance * `size` count as zero.
MatrixXd NullSpace(const MatrixXd& X, double size) {
  if (X.rows() == 0) return MatrixXd::Identity(X.cols(), X.cols());
  const Eigen::JacobiSVD<MatrixXd> svd(X, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixV().rightCols(X.cols() - RankOf(svd.singularValues(), size));
}

MatrixXd WithUnitColumns(MatrixXd X) {
  for (Index j = 0; j < X.cols(); ++j) {
    const double norm = X.col(j).norm();
    if (norm > 0.0) X.col(j) /= norm;
  }
  return X;
}

MatrixXd Beside(const MatrixXd& left, const MatrixXd& right) {
  MatrixXd both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

}  // namespace

int NumericalRank(const MatrixXd& A, double tolerance) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const VectorXd& s = svd.singularValues();
  return static_cast<int>((s.array() > tolerance * s[0]).count());
}

Eigen::VectorXcd InvariantZeros(const MatrixXd& A_given, const MatrixXd& B_given,
                                const MatrixXd& C_given) {
  const Index n = A_given.rows(), m = B_given.cols();
  if (A_given.cols() != n || B_given.rows() != n || C_given.cols() != n || C_given.rows() != m) {
    throw std::invalid_argument("InvariantZeros: A n x n, B n x m, C m x n");
  }
  const VectorXd scale = BalancingScale(A_given);
  const MatrixXd A = scale.cwiseInverse().asDiagonal() * A_given * scale.asDiagonal();
  const MatrixXd B = WithUnitColumns(scale.cwiseInverse().asDiagonal() * B_given);
  const MatrixXd Ct = WithUnitColumns(scale.asDiagonal() * C_given.transpose());
  const double size = A.norm();
  MatrixXd V = NullSpace(Ct.transpose(), 1.0);
  for (;;) {
    const MatrixXd across = NullSpace(Beside(V, B).transpose(), 1.0);
    const MatrixXd leaves = across.transpose() * A * V;
    const MatrixXd kept = NullSpace(leaves, size);
    if (kept.cols() == V.cols()) break;
    V = V * kept;
    if (V.cols() == 0) return {};
  }
  const MatrixXd VB = Beside(V, B);
  if (Ct.cols() < m || NumericalRank(VB) < VB.cols() || NumericalRank(Ct) < m) {
    throw std::invalid_argument("InvariantZeros: the system is not invertible");
  }
  const MatrixXd AV = A * V;
  const MatrixXd X = Eigen::ColPivHouseholderQR<MatrixXd>(VB).solve(AV);
  const MatrixXd on_V = X.topRows(V.cols());
  return Eigen::EigenSolver<MatrixXd>(on_V, false).eigenvalues();
}

Integrators CountIntegrators(const MatrixXd& A_given, double at) {
  const Index n = A_given.rows();
  const VectorXd scale = BalancingScale(A_given);
  MatrixXd A = scale.cwiseInverse().asDiagonal() * A_given * scale.asDiagonal();
  A -= at * MatrixXd::Identity(n, n);
  const double size = A.norm();
  // null A^k grows with k until it holds all of them: x with A x in null A^(k-1).
  MatrixXd V(n, 0);
  int chains = 0;
  for (;;) {
    const MatrixXd across = NullSpace(V.transpose(), 1.0);
    const MatrixXd next = NullSpace(across.transpose() * A, size);
    if (chains == 0) chains = static_cast<int>(next.cols());
    if (next.cols() == V.cols()) return {static_cast<int>(V.cols()), chains};
    V = next;
  }
}

}  // namespace flexarm
