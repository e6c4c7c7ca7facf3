// Chapter 6's order reduction a second time: another model (mass_point_arm.h), and power elements
// by Gramians with a discount instead of modes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/units.h"
#include "tests/tools/thesis/second_method/mass_point_arm.h"
#include "tests/tools/thesis/second_method/shipped_arm.h"
#include "tools/analysis/reduction_grid.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using second_method::MassPointArm;

constexpr int kModes = 10;     // M of figures 6.3 to 6.9
constexpr int kElements = 40;  // mode 10 errs by 4e-4 of its frequency

// The arm about motions with one elbow angle: the forces are quadratic in the rates.
struct AtElbow {
  AtElbow(const MassPointArm& arm, double theta2_rad) : q(VectorXd::Zero(arm.dof())) {
    q[1] = q[3] = theta2_rad;
    const MatrixXd M = arm.Mass(q);
    const Eigen::LLT<MatrixXd> mass(M);
    const auto by_position = [&](double rate1, double rate2) {
      VectorXd v = VectorXd::Zero(arm.dof());
      v[0] = v[2] = rate1;
      v[1] = v[3] = rate2;
      return MatrixXd(mass.solve(arm.BiasByPosition(q, v)));
    };
    first = by_position(1.0, 0.0);
    second = by_position(0.0, 1.0);
    both = by_position(1.0, 1.0) - first - second;
    still = mass.solve(arm.stiffness());
    input = mass.solve(arm.Input());
  }

  /// Q2 of (6.21): z'' = -Q2 z + input u.
  MatrixXd Q2(double rate1, double rate2) const {
    return still + rate1 * rate1 * first + rate1 * rate2 * both + rate2 * rate2 * second;
  }

  VectorXd q;
  MatrixXd first, second, both, still, input;
};

// A turn of the whole arm moves no link, nor does one of the elbow at rest: coordinates without
// them, in which nothing grows. th3 - th1, th2 unless at rest, th4 - th2, and the deflections.
struct Relative {
  Relative(const MatrixXd& Q2, const MatrixXd& input_of_all, bool at_rest) {
    const Index n = Q2.rows(), angles = at_rest ? 2 : 3;
    MatrixXd down = MatrixXd::Zero(angles + n - 4, n), up = MatrixXd::Zero(n, angles + n - 4);
    down(0, 2) = 1.0, down(0, 0) = -1.0;
    down(1, 3) = 1.0, down(1, 1) = -1.0;
    up(2, 0) = up(3, 1) = 1.0;
    if (!at_rest) down(2, 1) = up(1, 2) = up(3, 2) = 1.0;
    down.bottomRightCorner(n - 4, n - 4).setIdentity();
    up.bottomRightCorner(n - 4, n - 4).setIdentity();
    Q = down * Q2 * up;
    input = down * input_of_all;
  }
  MatrixXd Q, input;
};

// Twice the mean square of the impulse responses, the newer the heavier: 4 d X with
// (A - d) X + X (A - d)' + B B' = 0, instead of (6.17)'s limit. No modes, no rho. Of the
// deflections.
VectorXd DiscountedPower(const MatrixXd& Q2, const MatrixXd& input, bool at_rest) {
  constexpr double kDiscount_per_s = 0.01;
  constexpr double kRate_rad_s = 50.0;  // unit of the rates, so that both halves are of a size
  const Relative arm(Q2, input, at_rest);
  const Index n = arm.Q.rows();
  MatrixXd A = -kDiscount_per_s * MatrixXd::Identity(2 * n, 2 * n);
  A.topRightCorner(n, n) += kRate_rad_s * MatrixXd::Identity(n, n);
  A.bottomLeftCorner(n, n) -= arm.Q / kRate_rad_s;
  MatrixXd B = MatrixXd::Zero(2 * n, 2);
  B.bottomRows(n) = arm.input / kRate_rad_s;
  const Eigen::ComplexSchur<MatrixXcd> schur(A.cast<std::complex<double>>());
  const MatrixXcd &U = schur.matrixU(), &T = schur.matrixT();
  const MatrixXcd C = U.adjoint() * (B * B.transpose()).cast<std::complex<double>>() * U;
  MatrixXcd Y = MatrixXcd::Zero(2 * n, 2 * n);
  for (Index k = 2 * n - 1; k >= 0; --k) {  // T Y + Y T* = -C, from the last column on
    Eigen::VectorXcd right = -C.col(k);
    for (Index j = k + 1; j < 2 * n; ++j) right -= std::conj(T(k, j)) * Y.col(j);
    const MatrixXcd shifted = T + std::conj(T(k, k)) * MatrixXcd::Identity(2 * n, 2 * n);
    Y.col(k) = shifted.triangularView<Eigen::Upper>().solve(right);
  }
  const VectorXd all = 4.0 * kDiscount_per_s * (U * Y * U.adjoint()).real().diagonal().head(n);
  VectorXd mu = VectorXd::Zero(Q2.rows());
  mu.tail(Q2.rows() - 4) = all.tail(Q2.rows() - 4);
  return mu;
}

// The same by modes of Q2, as any textbook has them: sum of (t_ik b_k / omega_k)^2.
struct ModalPower {
  ModalPower(const MatrixXd& Q2, const MatrixXd& input) {
    const Eigen::EigenSolver<MatrixXd> eigen(Q2);
    const MatrixXd T = eigen.eigenvectors().real();
    const MatrixXd b = T.partialPivLu().solve(input);
    mu = VectorXd::Zero(Q2.rows());
    for (Index k = 0; k < Q2.rows(); ++k) {
      const double square = eigen.eigenvalues()[k].real();
      zero += std::abs(square) < 1e-3 ? 1 : 0;
      negative += square <= -1e-3 ? 1 : 0;
      slow += square >= 1e-3 && square < 100.0 ? 1 : 0;  // the arm bends at 6 Hz and above
      if (square >= 1e-3) mu += T.col(k).cwiseAbs2() * b.row(k).squaredNorm() / square;
    }
  }
  VectorXd mu;
  int zero = 0, negative = 0, slow = 0;
};

// Factors from tip deflections to the scaling, for the modes of a link.
VectorXd Scale(const MassPointArm& arm, std::size_t i, ModalScaling scaling) {
  const auto& link = arm.link(i);
  VectorXd scale = VectorXd::Ones(kModes);
  for (Index k = 0; k < kModes; ++k) {
    if (scaling == ModalScaling::kMass) {
      scale[k] = std::sqrt(link.stiffness(k, k)) / link.frequency_rad_s[k];
    }
    double square = 0.0;
    for (const auto& point : link.point) square += point.mass_kg * point.psi[k] * point.psi[k];
    if (scaling == ModalScaling::kLength)
      scale[k] = std::sqrt(square / link.mass_per_m / link.length_m);
  }
  return scale;
}

// eps_1 and eps_2 of a link, percent.
std::array<double, 2> Shares(const VectorXd& mu, std::size_t link, const VectorXd& scale) {
  const VectorXd own =
      mu.segment(4 + kModes * static_cast<Index>(link), kModes).cwiseProduct(scale.cwiseAbs2());
  return {100.0 * own[0] / own.sum(), 100.0 * (own[0] + own[1]) / own.sum()};
}

struct Largest {
  double difference = 0.0;
  void Take(double a, double b) { difference = std::max(difference, std::abs(a - b)); }
};

// 6.5.3, 8000 cells in two scalings: each cell's shares, and with them the ranges, their spans and
// where they are largest. The elements leave 6e-6 % at most, measured.
TEST(SecondMethod, SharesOfTheFirstModesInEveryCell) {
  const ArmParameters shipped = ShippedArm();
  const MassPointArm arm(shipped, kModes, kElements);
  const ArmModel model(shipped, {kModes, kModes});
  const ReductionGrid grid;
  const std::vector<NominalMotion> centres = CentresOf(grid);
  const auto pairs = static_cast<std::size_t>(grid.cells * grid.cells);
  for (const ModalScaling scaling : {ModalScaling::kMass, ModalScaling::kLength}) {
    const std::vector<ReductionCell> cells = ReduceCells(model, centres, {.scaling = scaling});
    const VectorXd scale[] = {Scale(arm, 0, scaling), Scale(arm, 1, scaling)};
    Largest largest;
    for (std::size_t first = 0; first < centres.size(); first += pairs) {
      const AtElbow at(arm, centres[first].theta2_rad);
      for (std::size_t c = first; c < first + pairs; ++c) {
        const ModalPower power(at.Q2(centres[c].theta1_rate_rad_s, centres[c].theta2_rate_rad_s),
                               at.input);
        EXPECT_EQ(power.zero, cells[c].zero_roots) << c;
        EXPECT_EQ(power.negative, cells[c].negative_roots) << c;
        EXPECT_EQ(power.slow > 0, cells[c].rigid_share_percent > 0.0) << c;
        for (const std::size_t link : {0U, 1U}) {
          const auto shares = Shares(power.mu, link, scale[link]);
          largest.Take(shares[0], cells[c].epsilon_1_percent[link]);
          largest.Take(shares[1], cells[c].epsilon_2_percent[link]);
        }
      }
    }
    EXPECT_LT(largest.difference, 2e-5);
  }
}

// The fastest rates of joint 1, without the modes of the test above. The discount leaves its square
// over that of the least difference of two frequencies: 0.0025 % at most, measured.
TEST(SecondMethod, SharesByDiscountedGramians) {
  const ArmParameters shipped = ShippedArm();
  const MassPointArm arm(shipped, kModes, kElements);
  const ArmModel model(shipped, {kModes, kModes});
  Largest largest;
  for (const double degrees : {2.25, 29.25, 47.25, 87.75}) {
    const AtElbow at(arm, degrees * kRadPerDeg);
    for (const double rate1 : {-4.0, 4.0}) {
      for (const double rate2 : {-6.0, 0.0, 6.0}) {
        const VectorXd mu = DiscountedPower(at.Q2(rate1, rate2), at.input, false);
        for (const ModalScaling scaling : {ModalScaling::kMass, ModalScaling::kLength}) {
          const ReductionCell cell =
              ReduceCell(model, {degrees * kRadPerDeg, rate1, rate2}, {.scaling = scaling});
          for (const std::size_t link : {0U, 1U}) {
            const auto shares = Shares(mu, link, Scale(arm, link, scaling));
            largest.Take(shares[0], cell.epsilon_1_percent[link]);
            largest.Take(shares[1], cell.epsilon_2_percent[link]);
          }
        }
      }
    }
  }
  EXPECT_LT(largest.difference, 5e-3);
}

// 6.4: the first mode of link 1 at rest, in three scalings.
TEST(SecondMethod, TheScalingDecidesTheShare) {
  const ArmParameters shipped = ShippedArm();
  const MassPointArm arm(shipped, kModes, kElements);
  const AtElbow at(arm, 0.0);
  const VectorXd mu = DiscountedPower(at.Q2(0.0, 0.0), at.input, true);
  const double expected[] = {99.20, 95.41, 99.99};
  int i = 0;
  for (const ModalScaling scaling :
       {ModalScaling::kMass, ModalScaling::kLength, ModalScaling::kTip}) {
    EXPECT_NEAR(Shares(mu, 0, Scale(arm, 0, scaling))[0], expected[i++], 0.0051);
  }
}

// 6.4: the mean over 60 s, by the integrals of products of sines in place of time steps.
TEST(SecondMethod, SixtySecondsBySumsOfSines) {
  const MassPointArm arm(ShippedArm(), kModes, kElements);
  const AtElbow at(arm, 0.0);
  const MatrixXd Q2 = at.Q2(0.0, 0.0);
  const Eigen::EigenSolver<MatrixXd> eigen(Q2);
  const MatrixXd T = eigen.eigenvectors().real(), b = T.partialPivLu().solve(at.input);
  constexpr double kTime_s = 60.0;
  const auto mean_cosine = [](double omega) {
    return omega == 0.0 ? 1.0 : std::sin(omega * kTime_s) / (omega * kTime_s);
  };
  const VectorXd mu = ModalPower(Q2, at.input).mu;
  double worst = 0.0;
  for (Index i = 4; i < Q2.rows(); ++i) {
    double mean = 0.0;
    for (Index k = 0; k < Q2.rows(); ++k) {
      for (Index l = 0; l < Q2.rows(); ++l) {
        const double square_k = eigen.eigenvalues()[k].real(),
                     square_l = eigen.eigenvalues()[l].real();
        if (square_k < 1.0 || square_l < 1.0) continue;  // rigid: no part in the deflections
        const double omega_k = std::sqrt(square_k), omega_l = std::sqrt(square_l);
        mean += T(i, k) * T(i, l) * b.row(k).dot(b.row(l)) / omega_k / omega_l *
                (mean_cosine(omega_k - omega_l) - mean_cosine(omega_k + omega_l));
      }
    }
    worst = std::max(worst, std::abs(mean / mu[i] - 1.0));
  }
  EXPECT_NEAR(100.0 * worst, 0.075, 5e-4);
}

}  // namespace
}  // namespace flexarm
