#include "model/reduction/balanced_truncation.h"

#include <stdexcept>

#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

MatrixXcd Response(const StateSpace& s, double omega_rad_s) {
  if (s.A.rows() == 0) return MatrixXcd::Zero(s.C.rows(), s.B.cols());
  const Index n = s.A.rows();
  const MatrixXcd resolvent = Complex(0.0, omega_rad_s) * MatrixXcd::Identity(n, n) - s.A;
  return s.C * resolvent.partialPivLu().solve(s.B.cast<Complex>());
}

double Largest(const MatrixXcd& G) { return Eigen::JacobiSVD<MatrixXcd>(G).singularValues()[0]; }

}  // namespace

BalancedSystem BalanceGramians(const StateSpace& system, double margin_per_s) {
  const SplitSystem split = SplitStable(system, margin_per_s);
  BalancedSystem out;
  out.rest = split.rest;
  out.stable = split.stable;
  out.L = split.V_stable;
  if (split.stable.A.rows() == 0) return out;
  const MatrixXd F = GramianFactor(split.stable.A, split.stable.B);
  const MatrixXd R = GramianFactor(split.stable.A.transpose(), split.stable.C.transpose());
  const Eigen::JacobiSVD<MatrixXd> svd(R.transpose() * F,
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
  out.hankel = svd.singularValues();
  // States below round-off of the largest are neither controllable nor observable: they get no
  // coordinates.
  const Index states = (out.hankel.array() > 1e-14 * out.hankel[0]).count();
  const Eigen::VectorXd scale = out.hankel.head(states).cwiseSqrt().cwiseInverse();
  const MatrixXd T = F * svd.matrixV().leftCols(states) * scale.asDiagonal();
  const MatrixXd W =
      scale.asDiagonal() * svd.matrixU().leftCols(states).transpose() * R.transpose();
  out.stable = {W * split.stable.A * T, W * split.stable.B, split.stable.C * T};
  out.L = split.V_stable * T;
  return out;
}

StateSpace Truncated(const BalancedSystem& system, int order) {
  if (order < 0 || order > static_cast<int>(system.stable.A.rows())) {
    throw std::invalid_argument("balanced truncation: order must lie in 0 .. " +
                                std::to_string(system.stable.A.rows()));
  }
  const Index k = order, r = system.rest.A.rows();
  StateSpace out{MatrixXd::Zero(r + k, r + k), MatrixXd(r + k, system.stable.B.cols()),
                 MatrixXd(system.stable.C.rows(), r + k)};
  out.A.topLeftCorner(r, r) = system.rest.A;
  out.A.bottomRightCorner(k, k) = system.stable.A.topLeftCorner(k, k);
  out.B << system.rest.B, system.stable.B.topRows(k);
  out.C << system.rest.C, system.stable.C.leftCols(k);
  return out;
}

double ErrorBound(const BalancedSystem& system, int order) {
  return 2.0 * system.hankel.tail(system.hankel.size() - order).sum();
}

double Gain(const StateSpace& system, double omega_rad_s) {
  return Largest(Response(system, omega_rad_s));
}

double GainOfDifference(const StateSpace& a, const StateSpace& b, double omega_rad_s) {
  return Largest(Response(a, omega_rad_s) - Response(b, omega_rad_s));
}

}  // namespace flexarm
