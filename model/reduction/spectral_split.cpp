#include "model/reduction/spectral_split.h"

#include <Eigen/Jacobi>
#include <cmath>
#include <stdexcept>

#include "model/math/dense_decompositions.h"
#include "model/math/matrix_scaling.h"

namespace flexarm {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

void CheckSystem(const StateSpace& s) {
  const Index n = s.A.rows();
  if (n < 1 || s.A.cols() != n || s.B.rows() != n || s.B.cols() < 1 || s.C.cols() != n ||
      s.C.rows() < 1) {
    throw std::invalid_argument("linear system: A must be square, B as tall, C as wide");
  }
  if (!s.A.allFinite() || !s.B.allFinite() || !s.C.allFinite()) {
    throw std::invalid_argument("linear system: an entry is not a finite number");
  }
}

// Swaps the eigenvalues at i and i + 1 of the upper triangular T, with A = Z T Z^H kept.
void SwapNeighbours(Index i, MatrixXcd* T, MatrixXcd* Z) {
  const Complex first = (*T)(i, i), second = (*T)(i + 1, i + 1);
  Eigen::JacobiRotation<Complex> turn;
  turn.makeGivens((*T)(i, i + 1), second - first);
  T->applyOnTheLeft(i, i + 1, turn.adjoint());
  T->applyOnTheRight(i, i + 1, turn);
  Z->applyOnTheRight(i, i + 1, turn);
  (*T)(i + 1, i) = 0.0;
  (*T)(i, i) = second;
  (*T)(i + 1, i + 1) = first;
}

// Moves eigenvalues left of the line to the top; returns how many there are.
Index OrderStableFirst(double line, MatrixXcd* T, MatrixXcd* Z) {
  Index stable = 0;
  for (Index i = 0; i < T->rows(); ++i) {
    if (!((*T)(i, i).real() < line)) continue;
    for (Index k = i; k > stable; --k) SwapNeighbours(k - 1, T, Z);
    ++stable;
  }
  return stable;
}

// X of T11 X - X T22 = -T12, T upper triangular: column by column.
MatrixXcd TriangularSylvester(const MatrixXcd& T, Index stable) {
  const Index rest = T.rows() - stable;
  MatrixXcd X(stable, rest);
  for (Index j = 0; j < rest; ++j) {
    MatrixXcd left = T.topLeftCorner(stable, stable);
    left.diagonal().array() -= T(stable + j, stable + j);
    if (stable > 0 && !(left.diagonal().cwiseAbs().minCoeff() > 0.0)) {
      throw std::domain_error("linear system: its stable part cannot be separated from the rest");
    }
    const MatrixXcd right =
        X.leftCols(j) * T.block(stable, stable + j, j, 1) - T.block(0, stable + j, stable, 1);
    X.col(j) = left.triangularView<Eigen::Upper>().solve(right);
  }
  return X;
}

// The part of the system in the range of the real projector `projector`, of the given rank.
StateSpace Part(const StateSpace& s, const MatrixXd& projector, Index rank, MatrixXd* V) {
  const Eigen::JacobiSVD<MatrixXd> svd(projector, Eigen::ComputeFullU);
  *V = svd.matrixU().leftCols(rank);
  const MatrixXd W = V->transpose() * projector;  // W V = 1, as the projector maps V to itself
  return {W * s.A * *V, W * s.B, s.C * *V};
}

}  // namespace

SplitSystem SplitStable(const StateSpace& system, double margin_per_s) {
  CheckSystem(system);
  if (!(margin_per_s > 0.0)) throw std::invalid_argument("linear system: margin must be positive");
  // In balanced coordinates: mixed units lose no digits.
  const Eigen::VectorXd t = BalancingScale(system.A);
  const Eigen::VectorXd t_inverse = t.cwiseInverse();
  const StateSpace balanced{t_inverse.asDiagonal() * system.A * t.asDiagonal(),
                            t_inverse.asDiagonal() * system.B, system.C * t.asDiagonal()};
  const Eigen::ComplexSchur<MatrixXd> schur(balanced.A);
  MatrixXcd T = schur.matrixT(), Z = schur.matrixU();
  const Index n = T.rows(), stable = OrderStableFirst(-margin_per_s, &T, &Z), rest = n - stable;
  const MatrixXcd X = TriangularSylvester(T, stable);
  const MatrixXcd left = Z.leftCols(stable).adjoint() - X * Z.rightCols(rest).adjoint();
  const MatrixXd projector = (Z.leftCols(stable) * left).real();
  SplitSystem split;
  split.stable = Part(balanced, projector, stable, &split.V_stable);
  split.rest = Part(balanced, MatrixXd::Identity(n, n) - projector, rest, &split.V_rest);
  split.V_stable = t.asDiagonal() * split.V_stable;
  split.V_rest = t.asDiagonal() * split.V_rest;
  return split;
}

MatrixXd GramianFactor(const MatrixXd& A, const MatrixXd& B) {
  const Index n = A.rows();
  const Eigen::ComplexSchur<MatrixXd> schur(A);
  const MatrixXcd& T = schur.matrixT();
  MatrixXcd b = schur.matrixU().adjoint() * B;  // the remainder, from the last row upwards
  MatrixXcd U = MatrixXcd::Zero(n, n);          // T (UU^H) + (UU^H) T^H + b b^H = 0
  for (Index j = n - 1; j >= 0; --j) {
    const Complex lambda = T(j, j);
    if (!(lambda.real() < 0.0)) {
      throw std::invalid_argument("Gramian: A has an eigenvalue that is not in the left half");
    }
    const double tau = std::sqrt(-2.0 * lambda.real()), size = b.row(j).norm();
    if (size == 0.0) continue;
    U(j, j) = size / tau;
    const MatrixXcd direction = b.row(j) / size;
    MatrixXcd left = T.topLeftCorner(j, j);
    left.diagonal().array() += std::conj(lambda);
    const MatrixXcd right =
        -T.block(0, j, j, 1) * U(j, j) - tau * (b.topRows(j) * direction.adjoint());
    U.block(0, j, j, 1) = left.triangularView<Eigen::Upper>().solve(right);
    b.topRows(j) -= tau * (U.block(0, j, j, 1) * direction);
  }
  // P is real: [Re F, Im F] is a factor as well, and its triangular one is n x n.
  const MatrixXcd F = schur.matrixU() * U;
  MatrixXd both(2 * n, n);
  both << F.real().transpose(), F.imag().transpose();
  const Eigen::HouseholderQR<MatrixXd> qr(both);
  return qr.matrixQR().topRows(n).triangularView<Eigen::Upper>().toDenseMatrix().transpose();
}

}  // namespace flexarm
