#pragma once

#include <Eigen/Dense>
#include <array>

#include "model/arm/arm_constants.h"
#include "model/math/small_cholesky.h"

namespace flexarm {

/// Rates, accelerations or coordinates of the arm. Vec: a vector of the modes of a link.
template <typename Vec>
struct ArmCoordinates {
  std::array<double, 4> th;  // th1..th4
  Vec f1, f2;
};

/// Right side of (M + h/2 D + h^2/4 K) a = r, apart from the bias. Vec as in ArmCoordinates.
template <typename Vec>
struct AppliedForces {
  double th1, th2, th4;  // th3 is eliminated beforehand
  Vec f1, f2;
  double K2h;    // joint 2 on the left: h^2/4 of its stiffness and h/2 of its damping
  double drag4;  // h/2 of the drag's slope on th4
};

/// Constants of the arm with links padded to M modes, in fixed-size form.
template <int M>
struct FixedConstants {
  using Vec = Eigen::Matrix<double, M, 1>;
  using Mat = Eigen::Matrix<double, M, M>;

  explicit FixedConstants(const ArmConstants& c);

  double L1, I1, m, Sx, I2, Ir2, J1, J2, Ip, K1, K2, b1, b2;
  Vec a1, p1, s1;  // link 1: int lam u psi, psi(L) and psi'(L)
  Vec k2, a2, s2;  // link 2: int lam psi and int lam u psi with payload, psi'(L)
  Mat N1, D1, G1, N2, D2, G2;
};

/// Matrices that depend on the step h only: A = N + h/2 D + h^2/4 G of each link, inverted, and its
/// products with the three vectors through which the link is coupled to the rest. h = 0 gives the
/// plain masses.
template <int M>
struct StepConstants {
  using Vec = Eigen::Matrix<double, M, 1>;
  using Mat = Eigen::Matrix<double, M, M>;

  StepConstants(const FixedConstants<M>& c, double step);

  double h;
  Mat A1_inv, A2_inv;
  Vec x_a1, x_p1, x_s1;    // A1^-1 [a1 p1 s1]
  Vec x_k2, x_a2, x_s2;    // A2^-1 [k2 a2 s2]
  Eigen::Matrix3d X1, X2;  // [a1 p1 s1]' A1^-1 [a1 p1 s1], the same of link 2
  Mat DhG1, DhG2;          // D + h/2 G
  double K1h, K2h;         // h^2/4 K
  double b1h, b2h;         // h/2 of the viscous friction
  double rotor1;           // K1h / (J1 + K1h)
};

template <int M>
FixedConstants<M>::FixedConstants(const ArmConstants& c)
    : L1(c.L1),
      I1(c.I1),
      m(c.m_outboard),
      Sx(c.Sx),
      I2(c.I2),
      Ir2(c.Ir2),
      J1(c.J1),
      J2(c.J2),
      Ip(c.Ip),
      K1(c.K1),
      K2(c.K2),
      b1(c.viscous[0]),
      b2(c.viscous[1]) {
  const auto pad = [](const Eigen::VectorXd& x) {
    Vec y = Vec::Zero();
    for (Eigen::Index i = 0; i < x.size(); ++i) y[i] = x[i];  // no packets: M may be 1
    return y;
  };
  const auto pad_matrix = [](const Eigen::MatrixXd& x, double diagonal) {
    Mat y = diagonal * Mat::Identity();
    y.topLeftCorner(x.rows(), x.cols()) = x;
    return y;
  };
  a1 = pad(c.link1.a), p1 = pad(c.link1.psi_tip), s1 = pad(c.link1.slope_tip);
  k2 = pad(c.k2), a2 = pad(c.a2), s2 = pad(c.link2.slope_tip);
  N1 = pad_matrix(c.link1.N, 1.0), D1 = pad_matrix(c.link1.D, 0.0);
  G1 = pad_matrix(c.link1.G, 0.0), N2 = pad_matrix(c.N2, 1.0);
  D2 = pad_matrix(c.link2.D, 0.0), G2 = pad_matrix(c.link2.G, 0.0);
}

template <int M>
StepConstants<M>::StepConstants(const FixedConstants<M>& c, double step) : h(step) {
  const double half = 0.5 * h, quarter = 0.25 * h * h;
  DhG1 = c.D1 + half * c.G1, DhG2 = c.D2 + half * c.G2;
  const Mat A1 = c.N1 + half * c.D1 + quarter * c.G1;
  const Mat A2 = c.N2 + half * c.D2 + quarter * c.G2;
  const Mat I = Mat::Identity();
  A1_inv = SmallCholesky<M>(A1).Solve(I);
  A2_inv = SmallCholesky<M>(A2).Solve(I);
  Eigen::Matrix<double, M, 3> C1, C2;
  C1 << c.a1, c.p1, c.s1;
  C2 << c.k2, c.a2, c.s2;
  const Eigen::Matrix<double, M, 3> Y1 = A1_inv * C1, Y2 = A2_inv * C2;
  x_a1 = Y1.col(0), x_p1 = Y1.col(1), x_s1 = Y1.col(2);
  x_k2 = Y2.col(0), x_a2 = Y2.col(1), x_s2 = Y2.col(2);
  X1 = C1.transpose() * Y1, X2 = C2.transpose() * Y2;
  K1h = quarter * c.K1, K2h = quarter * c.K2;
  b1h = half * c.b1, b2h = half * c.b2;
  rotor1 = K1h / (c.J1 + K1h);
}

}  // namespace flexarm
