#pragma once

// Bodies of articulated_arm.h, which includes this at its end.

#include "model/math/small_cholesky.h"

namespace flexarm {

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

template <int M>
void ArticulatedArm<M>::Turn(const ArmCoordinates<M>& q, const ArmCoordinates<M>& v) noexcept {
  w_ = c_.p1.dot(q.f1), w_dot_ = c_.p1.dot(v.f1), s_ = c_.s1.dot(q.f1);
  e_ = 1.0 / (1.0 + s_ * s_);
  const double root = std::sqrt(e_), alpha_dot = e_ * c_.s1.dot(v.f1);
  const double sine = std::sin(q.th[1]), cosine = std::cos(q.th[1]);
  sb_ = root * (sine + s_ * cosine), cb_ = root * (cosine - s_ * sine);
  gamma_dot_ = v.th[0] + v.th[1] + alpha_dot;
  kappa_ = -2.0 * s_ * alpha_dot * alpha_dot;
  // Elbow acceleration without any q'', in frame 2.
  const double w1 = v.th[0];
  const double x1 = -2.0 * w1 * w_dot_ - w1 * w1 * c_.L1, y1 = -w1 * w1 * w_;
  X_ = cb_ * x1 + sb_ * y1, Y_ = -sb_ * x1 + cb_ * y1;
  // Elbow velocity in frame 2 per unit th1': along and across link 2.
  tx_ = -cb_ * w_ + sb_ * c_.L1, ty_ = sb_ * w_ + cb_ * c_.L1;
}

template <int M>
void ArticulatedArm<M>::EliminateLink2(const ArmCoordinates<M>& q, const ArmCoordinates<M>& v,
                                       const AppliedForces<M>& r) noexcept {
  const Vec N2f2 = c_.N2 * q.f2;
  const double s2 = c_.s2.dot(q.f2), e2 = 1.0 / (1.0 + s2 * s2);
  const double alpha2_dot = e2 * c_.s2.dot(v.f2), kappa2 = -2.0 * s2 * alpha2_dot * alpha2_dot;
  const double g = gamma_dot_, gg = g * g;
  u_ = c_.Ip * e2;  // gamma'' acts on phi2 through a2 + u s2
  // A2 + Ip e2^2 s2 s2' by Sherman and Morrison.
  const double rho = c_.Ip * e2 * e2;
  phi_ = rho / (1.0 + rho * k_.X2(2, 2));
  const double shrink = 1.0 - phi_ * k_.X2(2, 2);
  const double Xks = k_.X2(0, 2) * shrink, Xas = k_.X2(1, 2) * shrink;
  const double Xss = k_.X2(2, 2) * shrink;
  const double Xkk = k_.X2(0, 0) - phi_ * k_.X2(0, 2) * k_.X2(0, 2);
  const double Xka = k_.X2(0, 1) - phi_ * k_.X2(0, 2) * k_.X2(1, 2);
  const double Xaa = k_.X2(1, 1) - phi_ * k_.X2(1, 2) * k_.X2(1, 2);
  m_y_ = c_.m - Xkk;
  Sx_ = c_.Sx - Xka - u_ * Xks;
  Sy_ = c_.k2.dot(q.f2);
  I_ = c_.I2 + N2f2.dot(q.f2) + c_.Ip - Xaa - 2.0 * u_ * Xas - u_ * u_ * Xss;
  r_f2_ = r.f2 + gg * N2f2 - (u_ * kappa2) * c_.s2;
  const double zs = k_.x_s2.dot(r_f2_) * shrink;
  const double zk = k_.x_k2.dot(r_f2_) - phi_ * k_.X2(0, 2) * zs / shrink;
  const double za = k_.x_a2.dot(r_f2_) - phi_ * k_.X2(1, 2) * zs / shrink;
  B_x_ = c_.m * X_ - Sy_ * kappa_ - gg * c_.Sx - 2.0 * g * c_.k2.dot(v.f2);
  B_y_ = m_y_ * Y_ + Sx_ * kappa_ - gg * Sy_ + zk;
  B_g_ =
      -Sy_ * X_ + Sx_ * Y_ + I_ * kappa_ + 2.0 * g * N2f2.dot(v.f2) + c_.Ip * kappa2 + za + u_ * zs;
}

template <int M>
void ArticulatedArm<M>::AssembleHub(const ArmCoordinates<M>& q, const ArmCoordinates<M>& v,
                                    const AppliedForces<M>& r) noexcept {
  const Vec N1f1 = c_.N1 * q.f1;
  const double motor = c_.Ir2 + c_.J2, w1 = v.th[0];
  const double along = -Sy_ * tx_ + Sx_ * ty_, nu = -Sy_ * sb_ + Sx_ * cb_;
  S11_ = c_.m * tx_ * tx_ + m_y_ * ty_ * ty_ + 2.0 * along + I_ + motor + c_.I1 + N1f1.dot(q.f1) +
         k_.b1h + k_.K1h * (1.0 - k_.rotor1);
  S12_ = along + I_, S22_ = I_ + r.K2h + k_.b2h;
  S14_ = c_.J2, S24_ = -r.K2h, S44_ = c_.J2 + r.K2h + r.drag4;
  S1w_ = c_.m * tx_ * sb_ + m_y_ * ty_ * cb_ + nu, S2w_ = nu;
  Sww_ = c_.m * sb_ * sb_ + m_y_ * cb_ * cb_;
  S1s_ = e_ * (along + I_ + motor), S2s_ = e_ * I_, S4s_ = e_ * c_.J2;
  Sws_ = e_ * nu, Sss_ = e_ * e_ * (I_ + motor);
  const double turning = B_g_ + motor * kappa_;
  g1_ = r.th1 - (tx_ * B_x_ + ty_ * B_y_ + turning + 2.0 * w1 * N1f1.dot(v.f1));
  g2_ = r.th2 - B_g_;
  g4_ = r.th4 - c_.J2 * kappa_;
  gw_ = -(sb_ * B_x_ + cb_ * B_y_);
  gs_ = -e_ * turning;
  r_f1_ = r.f1 + (w1 * w1) * N1f1;
}

// c = (w'', s'') = P (c0 - X_ca th1'') - R (S_c,theta theta'' - g_c), P = (1 + X_cc S_cc)^-1,
// R = P X_cc; and a1'f1'' likewise. Leaves c = (cw, cs) - C theta'' and the system in theta.
template <int M>
void ArticulatedArm<M>::EliminateLink1() noexcept {
  const double Xwa = k_.X1(1, 0), Xsa = k_.X1(2, 0);
  const double Xww = k_.X1(1, 1), Xws = k_.X1(1, 2), Xss = k_.X1(2, 2);
  const double n11 = 1.0 + Xww * Sww_ + Xws * Sws_, n12 = Xww * Sws_ + Xws * Sss_;
  const double n21 = Xws * Sww_ + Xss * Sws_, n22 = 1.0 + Xws * Sws_ + Xss * Sss_;
  const double scale = 1.0 / (n11 * n22 - n12 * n21);
  const double P11 = scale * n22, P12 = -scale * n12, P21 = -scale * n21, P22 = scale * n11;
  const double R11 = P11 * Xww + P12 * Xws, R12 = P11 * Xws + P12 * Xss,
               R22 = P21 * Xws + P22 * Xss;
  const double PXw = P11 * Xwa + P12 * Xsa, PXs = P21 * Xwa + P22 * Xsa;  // P X_ca
  const double za = k_.x_a1.dot(r_f1_), zw = k_.x_p1.dot(r_f1_), zs = k_.x_s1.dot(r_f1_);
  Cw1_ = PXw + R11 * S1w_ + R12 * S1s_, Cs1_ = PXs + R12 * S1w_ + R22 * S1s_;
  Cw2_ = R11 * S2w_ + R12 * S2s_, Cs2_ = R12 * S2w_ + R22 * S2s_;
  Cw4_ = R12 * S4s_, Cs4_ = R22 * S4s_;
  cw_ = P11 * zw + P12 * zs + R11 * gw_ + R12 * gs_;
  cs_ = P21 * zw + P22 * zs + R12 * gw_ + R22 * gs_;
  // a1'f1'' = za - Xaa th1'' - X_ac (S_c,theta theta'' + S_cc c - g_c)
  const double Yw = Xwa * Sww_ + Xsa * Sws_, Ys = Xwa * Sws_ + Xsa * Sss_;  // X_ac S_cc
  const double a_1 = k_.X1(0, 0) + Xwa * S1w_ + Xsa * S1s_ - Yw * Cw1_ - Ys * Cs1_;
  const double a_0 = za + Xwa * gw_ + Xsa * gs_ - Yw * cw_ - Ys * cs_;
  const double Z11 = S11_ - S1w_ * Cw1_ - S1s_ * Cs1_ - a_1;
  const double Z12 = S12_ - S2w_ * Cw1_ - S2s_ * Cs1_, Z14 = S14_ - S4s_ * Cs1_;
  const double Z22 = S22_ - S2w_ * Cw2_ - S2s_ * Cs2_, Z24 = S24_ - S4s_ * Cs2_;
  const double Z44 = S44_ - S4s_ * Cs4_;
  const double y1 = g1_ - S1w_ * cw_ - S1s_ * cs_ - a_0, y2 = g2_ - S2w_ * cw_ - S2s_ * cs_;
  const double y4 = g4_ - S4s_ * cs_;
  const double over = 1.0 / Z44;
  th4_0_ = over * y4, th4_1_ = over * Z14, th4_2_ = over * Z24;
  z11_ = Z11 - Z14 * th4_1_, z12_ = Z12 - Z14 * th4_2_, z22_ = Z22 - Z24 * th4_2_;
  r1_ = y1 - Z14 * th4_0_, r2_ = y2 - Z24 * th4_0_;
}

template <int M>
void ArticulatedArm<M>::Reduce(const ArmCoordinates<M>& q, const ArmCoordinates<M>& v,
                               const AppliedForces<M>& r) noexcept {
  Turn(q, v);
  EliminateLink2(q, v, r);
  AssembleHub(q, v, r);
  EliminateLink1();
}

template <int M>
void ArticulatedArm<M>::Expand(const std::array<double, 2>& hub,
                               ArmCoordinates<M>* a) const noexcept {
  const double th1 = hub[0], th2 = hub[1];
  const double th4 = th4_0_ - th4_1_ * th1 - th4_2_ * th2;
  a->th[0] = th1, a->th[1] = th2, a->th[3] = th4;
  const double w = cw_ - Cw1_ * th1 - Cw2_ * th2 - Cw4_ * th4;
  const double s = cs_ - Cs1_ * th1 - Cs2_ * th2 - Cs4_ * th4;
  const double force_w = S1w_ * th1 + S2w_ * th2 + Sww_ * w + Sws_ * s - gw_;
  const double force_s = S1s_ * th1 + S2s_ * th2 + S4s_ * th4 + Sws_ * w + Sss_ * s - gs_;
  const Vec y1 = r_f1_ - th1 * c_.a1 - force_w * c_.p1 - force_s * c_.s1;
  a->f1.noalias() = k_.A1_inv * y1;
  const double across = ty_ * th1 + cb_ * w + Y_, turn = th1 + th2 + e_ * s + kappa_;
  const Vec y2 = r_f2_ - across * c_.k2 - turn * c_.a2 - (turn * u_) * c_.s2;
  a->f2.noalias() = k_.A2_inv * y2;
  a->f2 -= (phi_ * k_.x_s2.dot(y2)) * k_.x_s2;
}

}  // namespace flexarm
