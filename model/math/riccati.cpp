#include "model/math/riccati.h"

#include <complex>
#include <stdexcept>
#include <string>

#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

MatrixXd Symmetric(const MatrixXd& X) { return 0.5 * (X + X.transpose()); }

void CheckDare(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R) {
  const Eigen::Index n = A.rows(), m = B.cols();
  if (n == 0 || A.cols() != n || B.rows() != n || Q.rows() != n || Q.cols() != n || R.rows() != m ||
      R.cols() != m) {
    throw std::invalid_argument("SolveDare: sizes do not fit");
  }
  if (R.llt().info() != Eigen::Success) {
    throw std::invalid_argument("SolveDare: R must be positive definite");
  }
}

// One Newton correction: with the closed loop F = A - B K, solve D - F'D F = residual.
MatrixXd Refined(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R,
                 const MatrixXd& P) {
  const MatrixXd K = DareGain(A, B, R, P), F = A - B * K;
  const MatrixXd residual = Symmetric(F.transpose() * P * F + K.transpose() * R * K + Q - P);
  return Symmetric(P + SolveStein(F.transpose(), F, residual));
}

// Newton until the residual stops falling. For a strongly unstable A doubling loses many digits.
MatrixXd Polished(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R,
                  MatrixXd P) {
  double residual = DareResidual(A, B, Q, R, P);
  for (int i = 0; i < 10; ++i) {
    const MatrixXd next = Refined(A, B, Q, R, P);
    const double next_residual = DareResidual(A, B, Q, R, next);
    if (!(next_residual < residual)) break;
    P = next;
    residual = next_residual;
  }
  const MatrixXd F = A - B * DareGain(A, B, R, P);
  if (!(residual < 1e-8) || !(F.eigenvalues().cwiseAbs().maxCoeff() < 1.0)) {
    throw std::runtime_error("SolveDare: no stabilising solution was found");
  }
  return P;
}

// Y - S Y T = F for upper triangular S and T.
MatrixXcd SolveTriangularStein(const MatrixXcd& S, const MatrixXcd& T, const MatrixXcd& F) {
  const MatrixXcd one = MatrixXcd::Identity(S.rows(), S.cols());
  MatrixXcd Y = MatrixXcd::Zero(F.rows(), F.cols());
  for (Eigen::Index j = 0; j < T.cols(); ++j) {
    const MatrixXcd left = one - T(j, j) * S;
    if (left.diagonal().cwiseAbs().minCoeff() < 1e-13) {
      throw std::runtime_error(
          "SolveStein: an eigenvalue of A times one of B is 1, so the solution is not unique");
    }
    const MatrixXcd right = F.col(j) + S * (Y.leftCols(j) * T.col(j).head(j));
    Y.col(j) = left.triangularView<Eigen::Upper>().solve(right);
  }
  return Y;
}

}  // namespace

MatrixXd DareGain(const MatrixXd& A, const MatrixXd& B, const MatrixXd& R, const MatrixXd& P) {
  const MatrixXd H = Symmetric(R + B.transpose() * P * B);
  const MatrixXd BtPA = B.transpose() * P * A;
  return H.llt().solve(BtPA);
}

double DareResidual(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R,
                    const MatrixXd& P) {
  const MatrixXd K = DareGain(A, B, R, P);
  const MatrixXd F = A - B * K;
  const MatrixXd residual = F.transpose() * P * F + K.transpose() * R * K + Q - P;
  return residual.cwiseAbs().maxCoeff() / P.cwiseAbs().maxCoeff();
}

MatrixXd SolveDare(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R) {
  CheckDare(A, B, Q, R);
  constexpr int kMaxDoublings = 60;
  const MatrixXd one = MatrixXd::Identity(A.rows(), A.cols());
  const MatrixXd Bt = B.transpose(), G = B * R.llt().solve(Bt);
  MatrixXd Ak = A, Gk = Symmetric(G), Hk = Symmetric(Q);
  for (int i = 0; i < kMaxDoublings; ++i) {
    const Eigen::PartialPivLU<MatrixXd> W(one + Gk * Hk);
    const MatrixXd WA = W.solve(Ak), WG = W.solve(Gk);
    const MatrixXd H_step = Symmetric(Ak.transpose() * Hk * WA);
    Gk = Symmetric(Gk + Ak * WG * Ak.transpose());
    Hk += H_step;
    Ak = (Ak * WA).eval();
    if (!Hk.allFinite() || !Gk.allFinite()) break;
    if (H_step.cwiseAbs().maxCoeff() <= 1e-15 * Hk.cwiseAbs().maxCoeff()) {
      return Polished(A, B, Q, R, Hk);
    }
  }
  throw std::runtime_error(
      "SolveDare: no convergence: a mode on or outside the unit circle is not reached by B, or one "
      "on it is not weighted by Q");
}

MatrixXd SolveStein(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C) {
  if (A.rows() != A.cols() || B.rows() != B.cols() || C.rows() != A.rows() ||
      C.cols() != B.rows() || C.size() == 0) {
    throw std::invalid_argument("SolveStein: sizes do not fit");
  }
  const Eigen::ComplexSchur<MatrixXd> a(A), b(B);
  MatrixXd X = MatrixXd::Zero(C.rows(), C.cols());
  for (int round = 0; round < 3; ++round) {  // the first solves, two refine
    const MatrixXd residual = C - (X - A * X * B);
    const MatrixXcd F = a.matrixU().adjoint() * residual * b.matrixU();
    const MatrixXcd Y = SolveTriangularStein(a.matrixT(), b.matrixT(), F);
    const MatrixXcd correction = a.matrixU() * Y * b.matrixU().adjoint();
    X += correction.real();
  }
  return X;
}

}  // namespace flexarm
