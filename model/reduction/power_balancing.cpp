#include "model/reduction/power_balancing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/math/matrix_scaling.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A root of Q3 with its eigenvector, and its maps to the halves of z.
struct Spectrum {
  Eigen::VectorXcd root;
  Eigen::MatrixXcd T1, T2, T2_inverse;
};

bool IsSymmetric(const MatrixXd& A) {
  return (A - A.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * A.cwiseAbs().maxCoeff();
}

void CheckSizes(const UndampedSystem& s) {
  const Index n = s.Q1.rows();
  if (n < 1 || s.Q1.cols() != n || s.Q2.rows() != n || s.Q2.cols() != n || s.B0.rows() != n ||
      s.B0.cols() < 1 || s.C0.cols() != n || s.C0.rows() < 1) {
    throw std::invalid_argument(
        "power balancing: Q1 and Q2 must be square of one size, B0 as tall, C0 as wide");
  }
  if (!s.Q1.allFinite() || !s.Q2.allFinite() || !s.B0.allFinite() || !s.C0.allFinite()) {
    throw std::invalid_argument("power balancing: an entry is not a finite number");
  }
}

PowerCondition ConditionOf(const UndampedSystem& s) {
  const bool symmetric =
      IsSymmetric(s.Q1) && IsSymmetric(s.Q2) && s.Q1.llt().info() == Eigen::Success;
  if (symmetric) return PowerCondition::kSymmetric;
  if (s.Q1 == MatrixXd::Identity(s.Q1.rows(), s.Q1.cols())) return PowerCondition::kDiagonalisable;
  throw std::invalid_argument(
      "power balancing: neither is Q1 symmetric positive definite with Q2 symmetric, nor is Q1 the "
      "identity");
}

// Q1 = S1 S1', S1' Q2 S1 = S2 D^2 S2': the condition of Han et al.
Spectrum SymmetricSpectrum(const UndampedSystem& s) {
  const Eigen::LLT<MatrixXd> S1(s.Q1);
  const MatrixXd L = S1.matrixL();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(L.transpose() * s.Q2 * L);
  const MatrixXd& S2 = eigen.eigenvectors();
  const MatrixXd T2 = S1.matrixU().solve(S2);
  return {eigen.eigenvalues(), L * S2, T2, S2.transpose() * L.transpose()};
}

// Q2 = S2 D^2 S2^-1: the relaxed condition.
Spectrum DiagonalisedSpectrum(const UndampedSystem& s) {
  const VectorXd t = BalancingScale(s.Q2);
  const MatrixXd balanced = t.cwiseInverse().asDiagonal() * s.Q2 * t.asDiagonal();
  const Eigen::EigenSolver<MatrixXd> eigen(balanced);
  if (eigen.info() != Eigen::Success) {
    throw std::domain_error("power balancing: the eigenvalues of Q2 were not found");
  }
  const Eigen::MatrixXcd S = eigen.eigenvectors();
  const Eigen::MatrixXcd inverse = S.partialPivLu().inverse() * t.cwiseInverse().asDiagonal();
  return {eigen.eigenvalues(), t.asDiagonal() * S, t.asDiagonal() * S, inverse};
}

// Reason to exclude a root; null if it oscillates.
const DroppedRoot::Reason* ReasonToDrop(std::complex<double> root, double rigid_below) {
  static constexpr DroppedRoot::Reason kRigid = DroppedRoot::Reason::kRigid,
                                       kNegative = DroppedRoot::Reason::kNegative,
                                       kComplex = DroppedRoot::Reason::kComplex;
  if (std::abs(root) < rigid_below) return &kRigid;
  if (root.imag() != 0.0) return &kComplex;
  return root.real() < 0.0 ? &kNegative : nullptr;
}

// Indices of the roots that are kept, ascending; the others are recorded.
std::vector<Index> Kept(const Spectrum& spectrum, double rigid_below, PowerBalance* balance) {
  std::vector<Index> order(static_cast<std::size_t>(spectrum.root.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index i, Index j) { return spectrum.root[i].real() < spectrum.root[j].real(); });
  std::vector<Index> kept;
  for (const Index i : order) {
    if (const auto* reason = ReasonToDrop(spectrum.root[i], rigid_below)) {
      balance->dropped.push_back({spectrum.root[i], *reason});
    } else {
      kept.push_back(i);
    }
  }
  for (std::size_t k = 1; k < kept.size(); ++k) {
    const double low = spectrum.root[kept[k - 1]].real(), high = spectrum.root[kept[k]].real();
    if (high - low < 1e-9 * high) {
      throw std::domain_error("power balancing: two roots coincide at " +
                              std::to_string(std::sqrt(high)) +
                              " rad/s; distinct frequencies are needed");
    }
  }
  return kept;
}

// The roots nearest to zero stem from rigid-body motions; some of them may have been dropped.
void MarkRigid(const PowerOptions& options, PowerBalance* balance) {
  std::vector<double> distance;
  distance.reserve(balance->mode.size() + balance->dropped.size());
  for (const PowerMode& mode : balance->mode) {
    distance.push_back(mode.frequency_rad_s * mode.frequency_rad_s);
  }
  for (const DroppedRoot& root : balance->dropped) {
    distance.push_back(std::abs(root.squared_frequency_rad2_s2));
  }
  std::sort(distance.begin(), distance.end());
  const auto rigid = std::min(distance.size(), static_cast<std::size_t>(options.rigid_roots));
  for (PowerMode& mode : balance->mode) {
    const double squared = mode.frequency_rad_s * mode.frequency_rad_s;
    mode.rigid_origin = rigid > 0 && squared <= distance[rigid - 1];
  }
}

}  // namespace

PowerBalance BalancePower(const UndampedSystem& system, const PowerOptions& options) {
  CheckSizes(system);
  PowerBalance balance;
  balance.condition = ConditionOf(system);
  const Spectrum spectrum = balance.condition == PowerCondition::kSymmetric
                                ? SymmetricSpectrum(system)
                                : DiagonalisedSpectrum(system);
  const std::vector<Index> kept = Kept(spectrum, options.rigid_below_rad2_s2, &balance);
  // Real roots have real eigenvectors: the imaginary part is zero.
  balance.T1 = spectrum.T1(Eigen::all, kept).real();
  balance.T2 = spectrum.T2(Eigen::all, kept).real();
  const Eigen::MatrixXd kept_rows = spectrum.T2_inverse(kept, Eigen::all).real();
  balance.b = kept_rows * system.B0;
  balance.c = system.C0 * balance.T1;
  balance.mu = balance.mu_rate = VectorXd::Zero(system.Q1.rows());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto i = static_cast<Index>(k);
    const double omega = std::sqrt(spectrum.root[kept[k]].real());
    const double b_norm = balance.b.row(i).norm(), c_norm = balance.c.col(i).norm();
    balance.mode.push_back({omega, b_norm, c_norm, b_norm * c_norm / omega, false});
    balance.mu += balance.T1.col(i).cwiseAbs2() * (b_norm * b_norm / (omega * omega));
    balance.mu_rate += balance.T2.col(i).cwiseAbs2() * (b_norm * b_norm);
  }
  MarkRigid(options, &balance);
  return balance;
}

PowerBalancedSystem Realize(const PowerBalance& balance, int modes) {
  if (modes < 1 || modes > static_cast<int>(balance.mode.size())) {
    throw std::invalid_argument("power balancing: keep 1 to " +
                                std::to_string(balance.mode.size()) + " modes");
  }
  std::vector<std::size_t> order(balance.mode.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return balance.mode[i].rho > balance.mode[j].rho;
  });
  const Index n = balance.T1.rows(), states = 2 * Index{modes};
  PowerBalancedSystem out{MatrixXd::Zero(states, states), MatrixXd::Zero(states, balance.b.cols()),
                          MatrixXd::Zero(balance.c.rows(), states), MatrixXd::Zero(2 * n, states)};
  for (Index k = 0; k < modes; ++k) {
    const std::size_t i = order[static_cast<std::size_t>(k)];
    const PowerMode& mode = balance.mode[i];
    if (!(mode.rho > 0.0)) {
      throw std::domain_error(
          "power balancing: a mode is not controllable or not observable, rho = 0");
    }
    const double omega = mode.frequency_rad_s;
    const double r = std::sqrt(mode.b_norm / (mode.c_norm * omega)), r_rate = r * omega;
    const auto at = static_cast<Index>(i);
    out.A(2 * k, 2 * k + 1) = omega;
    out.A(2 * k + 1, 2 * k) = -omega;
    out.B.row(2 * k + 1) = balance.b.row(at) / r_rate;
    out.C.col(2 * k) = balance.c.col(at) * r;
    out.L.block(0, 2 * k, n, 1) = balance.T1.col(at) * r;
    out.L.block(n, 2 * k + 1, n, 1) = balance.T2.col(at) * r_rate;
  }
  return out;
}

VectorXd TimeAveragedPower(const UndampedSystem& system, double time_s, double step_s) {
  CheckSizes(system);
  if (!(step_s > 0.0) || !(time_s > step_s)) {
    throw std::invalid_argument("power balancing: a time average needs 0 < step < time");
  }
  const Index n = system.Q1.rows();
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n), z = MatrixXd::Zero(2 * n, system.B0.cols());
  A.topRightCorner(n, n) = system.Q1;
  A.bottomLeftCorner(n, n) = -system.Q2;
  z.bottomRows(n) = system.B0;
  const MatrixXd step = MatrixExponential(A * step_s);
  const auto steps = static_cast<std::int64_t>(std::llround(time_s / step_s));
  VectorXd sum = VectorXd::Zero(2 * n);
  for (std::int64_t i = 0; i < steps; ++i) {
    z = (step * z).eval();
    sum += z.rowwise().squaredNorm();
  }
  return 2.0 * sum / static_cast<double>(steps);
}

}  // namespace flexarm
