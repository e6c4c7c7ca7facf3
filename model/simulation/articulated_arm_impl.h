#pragma once

// Bodies of articulated_arm.h, which includes this at its end.

#include <cmath>

namespace flexarm {

template <int M>
LinkMaps<M>::LinkMaps(const Mat& N, const Mat& G, const Mat& DhG, const Mat& A_inv,
                      const Couplings& c, const Eigen::Matrix<double, M, 2>& tip_vectors)
    : mass(N),
      stiffness(G),
      damping(DhG),
      inverse(A_inv),
      turned(Mat(A_inv * N)),
      reaction(Eigen::Matrix<double, 3, M>(c.transpose() * A_inv)),
      centrifugal(Eigen::Matrix<double, 3, M>(c.transpose() * A_inv * N)),
      tip(Eigen::Matrix<double, 2, M>(tip_vectors.transpose())) {
  const Couplings Y = A_inv * c;
  for (int k = 0; k < 3; ++k) {
    x[static_cast<std::size_t>(k)] = ModeVector<M>::Of([&](int i) { return Y(i, k); });
  }
}

template <int M>
ArticulatedStep<M>::ArticulatedStep(const FixedConstants<M>& c, const StepConstants<M>& k)
    : h(k.h),
      X1(k.X1),
      X2(k.X2),
      K1h(k.K1h),
      K2h(k.K2h),
      b1h(k.b1h),
      b2h(k.b2h),
      rotor1(k.rotor1),
      det1(k.X1(1, 1) * k.X1(2, 2) - k.X1(1, 2) * k.X1(1, 2)),
      link1(c.N1, c.G1, k.DhG1, k.A1_inv,
            (Eigen::Matrix<double, M, 3>() << c.a1, c.p1, c.s1).finished(),
            (Eigen::Matrix<double, M, 2>() << c.p1, c.s1).finished()),
      link2(c.N2, c.G2, k.DhG2, k.A2_inv,
            (Eigen::Matrix<double, M, 3>() << c.k2, c.a2, c.s2).finished(),
            (Eigen::Matrix<double, M, 2>() << c.k2, c.s2).finished()) {}

template <int M>
ArticulatedArm<M>::ArticulatedArm(const Constants& c, const Step& k, const Forces& r,
                                  double th2_m) noexcept
    : c_(c),
      k_(k),
      elbow_(th2_m),
      bent1_(k.link1.inverse * r.f1),
      bent2_(k.link2.inverse * r.f2),
      reaction1_(k.link1.reaction * r.f1),
      reaction2_(k.link2.reaction * r.f2) {}

template <int M>
void ArticulatedArm<M>::Bend(const Constants& /*c*/, const Step& k, const Coordinates& q,
                             const Coordinates& v, Forces* r) noexcept {
  r->f1 = -1.0 * (k.link1.stiffness * q.f1 + k.link1.damping * v.f1);
  r->f2 = -1.0 * (k.link2.stiffness * q.f2 + k.link2.damping * v.f2);
}

template <int M>
void ArticulatedArm<M>::Turn(const Coordinates& q, const Coordinates& v) noexcept {
  const ModeVector<2> tip = k_.link1.tip * q.f1, tip_dot = k_.link1.tip * v.f1;
  const double w_dot = tip_dot[0], s = tip[1], stretch = 1.0 + s * s;
  w_ = tip[0];
  e_ = 1.0 / stretch;
  const double root = e_ * std::sqrt(stretch), alpha_dot = e_ * tip_dot[1];
  const SineCosine th2 = elbow_.At(q.th[1]);
  sb_ = root * (th2.sine + s * th2.cosine), cb_ = root * (th2.cosine - s * th2.sine);
  gamma_dot_ = v.th[0] + v.th[1] + alpha_dot;
  kappa_ = -2.0 * s * alpha_dot * alpha_dot;
  // Elbow acceleration without any q'', in frame 2.
  const double w1 = v.th[0];
  const double x1 = -2.0 * w1 * w_dot - w1 * w1 * c_.L1, y1 = -w1 * w1 * w_;
  X_ = cb_ * x1 + sb_ * y1, Y_ = -sb_ * x1 + cb_ * y1;
  // Elbow velocity in frame 2 per unit th1': along and across link 2.
  tx_ = -cb_ * w_ + sb_ * c_.L1, ty_ = sb_ * w_ + cb_ * c_.L1;
}

template <int M>
void ArticulatedArm<M>::EliminateLink2(const Coordinates& q, const Coordinates& v) noexcept {
  const Eigen::Matrix3d& X = k_.X2;
  const Vec N2f2 = k_.link2.mass * q.f2;
  const ModeVector<2> tip = k_.link2.tip * q.f2, tip_dot = k_.link2.tip * v.f2;
  const double s2 = tip[1], stretch = 1.0 + s2 * s2, e2 = 1.0 / stretch;
  const double alpha2_dot = e2 * tip_dot[1], kappa2 = -2.0 * s2 * alpha2_dot * alpha2_dot;
  const double g = gamma_dot_, gg = g * g;
  u_ = c_.Ip * e2;  // gamma'' acts on phi2 through a2 + u s2
  // A2 + Ip e2^2 s2 s2' by Sherman and Morrison.
  phi_ = c_.Ip / (stretch * stretch + c_.Ip * X(2, 2));
  const double shrink = 1.0 - phi_ * X(2, 2);
  const double Xks = X(0, 2) * shrink, Xas = X(1, 2) * shrink, Xss = X(2, 2) * shrink;
  const double Xkk = X(0, 0) - phi_ * X(0, 2) * X(0, 2);
  const double Xka = X(0, 1) - phi_ * X(0, 2) * X(1, 2);
  const double Xaa = X(1, 1) - phi_ * X(1, 2) * X(1, 2);
  m_y_ = c_.m - Xkk;
  Sx_ = c_.Sx - Xka - u_ * Xks;
  Sy_ = tip[0];
  I_ = c_.I2 + N2f2.Dot(q.f2) + c_.Ip - Xaa - 2.0 * u_ * Xas - u_ * u_ * Xss;
  tip2_ = u_ * kappa2;
  free2_ = bent2_ + gg * (k_.link2.turned * q.f2);
  const ModeVector<3> z = reaction2_ + gg * (k_.link2.centrifugal * q.f2);
  z_s2_ = z[2] - tip2_ * X(2, 2);
  const double zk = z[0] - tip2_ * X(0, 2) - phi_ * X(0, 2) * z_s2_;
  const double za = z[1] - tip2_ * X(1, 2) - phi_ * X(1, 2) * z_s2_;
  B_x_ = c_.m * X_ - Sy_ * kappa_ - gg * c_.Sx - 2.0 * g * tip_dot[0];
  B_y_ = m_y_ * Y_ + Sx_ * kappa_ - gg * Sy_ + zk;
  B_g_ = -Sy_ * X_ + Sx_ * Y_ + I_ * kappa_ + 2.0 * g * N2f2.Dot(v.f2) + c_.Ip * kappa2 + za +
         u_ * (z_s2_ * shrink);
}

// th4'' = (g4 - J2 (th1'' + e s'') + K2h th2'') / S44 is eliminated here: what it leaves of J2 in
// the other equations is small, as the rotor hardly follows within a step.
template <int M>
void ArticulatedArm<M>::AssembleHub(const Coordinates& q, const Coordinates& v,
                                    const Forces& r) noexcept {
  const Vec N1f1 = k_.link1.mass * q.f1;
  const double w1 = v.th[0], w1w1 = w1 * w1;
  K2h_ = r.K2h;
  over4_ = 1.0 / (c_.J2 + r.K2h + r.drag4);
  const double share = c_.J2 * over4_;                       // of the torque on th4
  const double rotor = share * (r.K2h + r.drag4);            // left of J2 on th1 and s
  const double coupled = share * r.K2h;                      // between th2 and those
  const double spring = r.K2h * over4_ * (c_.J2 + r.drag4);  // left of K2h on th2
  const double motor = c_.Ir2 + rotor;
  const double along = -Sy_ * tx_ + Sx_ * ty_, nu = -Sy_ * sb_ + Sx_ * cb_;
  S11_ = c_.m * tx_ * tx_ + m_y_ * ty_ * ty_ + 2.0 * along + I_ + motor + c_.I1 + N1f1.Dot(q.f1) +
         k_.b1h + k_.K1h * (1.0 - k_.rotor1);
  S12_ = along + I_ + coupled, S22_ = I_ + spring + k_.b2h;
  S1w_ = c_.m * tx_ * sb_ + m_y_ * ty_ * cb_ + nu, S2w_ = nu;
  Sww_ = c_.m * sb_ * sb_ + m_y_ * cb_ * cb_;
  S1s_ = e_ * (along + I_ + motor), S2s_ = e_ * (I_ + coupled);
  Sws_ = e_ * nu, Sss_ = e_ * e_ * (I_ + motor);
  const double torque4 = share * r.th4, turning = B_g_ + motor * kappa_ + torque4;
  g1_ = r.th1 - (tx_ * B_x_ + ty_ * B_y_ + turning + 2.0 * w1 * N1f1.Dot(v.f1));
  g2_ = r.th2 + r.K2h * over4_ * r.th4 - (B_g_ + coupled * kappa_);
  g4_ = r.th4 - c_.J2 * kappa_;
  gw_ = -(sb_ * B_x_ + cb_ * B_y_);
  gs_ = -e_ * turning;
  free1_ = bent1_ + w1w1 * (k_.link1.turned * q.f1);
  z1_ = reaction1_ + w1w1 * (k_.link1.centrifugal * q.f1);
}

// c = (w'', s'') = P (c0 - X_ca th1'') - R (S_c,theta theta'' - g_c), P = (1 + X_cc S_cc)^-1,
// R = P X_cc; and a1'f1'' likewise. P and R are kept times the determinant of P^-1: det R =
// X_cc + det(X_cc) adj(S_cc). Leaves det c = (cw, cs) - C theta'' and the system in theta.
template <int M>
void ArticulatedArm<M>::EliminateLink1() noexcept {
  const double Xwa = k_.X1(1, 0), Xsa = k_.X1(2, 0);
  const double Xww = k_.X1(1, 1), Xws = k_.X1(1, 2), Xss = k_.X1(2, 2);
  const double P22 = 1.0 + Xww * Sww_ + Xws * Sws_, P12 = -(Xww * Sws_ + Xws * Sss_);
  const double P21 = -(Xws * Sww_ + Xss * Sws_), P11 = 1.0 + Xws * Sws_ + Xss * Sss_;
  const double det = P11 * P22 - P12 * P21;
  over_ = 1.0 / det;
  const double R11 = Xww + k_.det1 * Sss_, R12 = Xws - k_.det1 * Sws_, R22 = Xss + k_.det1 * Sww_;
  const double za = z1_[0], zw = z1_[1], zs = z1_[2];
  Cw1_ = P11 * Xwa + P12 * Xsa + R11 * S1w_ + R12 * S1s_;
  Cs1_ = P21 * Xwa + P22 * Xsa + R12 * S1w_ + R22 * S1s_;
  Cw2_ = R11 * S2w_ + R12 * S2s_, Cs2_ = R12 * S2w_ + R22 * S2s_;
  cw_ = P11 * zw + P12 * zs + R11 * gw_ + R12 * gs_;
  cs_ = P21 * zw + P22 * zs + R12 * gw_ + R22 * gs_;
  // a1'f1'' = za - Xaa th1'' - X_ac (S_c,theta theta'' + S_cc c - g_c)
  const double a_1 = k_.X1(0, 0) + Xwa * S1w_ + Xsa * S1s_, a_0 = za + Xwa * gw_ + Xsa * gs_;
  const double Tw = S1w_ - (Xwa * Sww_ + Xsa * Sws_), Ts = S1s_ - (Xwa * Sws_ + Xsa * Sss_);
  z11_ = S11_ - a_1 - over_ * (Tw * Cw1_ + Ts * Cs1_);
  z12_ = S12_ - over_ * (S2w_ * Cw1_ + S2s_ * Cs1_);
  z22_ = S22_ - over_ * (S2w_ * Cw2_ + S2s_ * Cs2_);
  r1_ = g1_ - a_0 - over_ * (Tw * cw_ + Ts * cs_);
  r2_ = g2_ - over_ * (S2w_ * cw_ + S2s_ * cs_);
}

template <int M>
void ArticulatedArm<M>::Reduce(const Coordinates& q, const Coordinates& v,
                               const Forces& r) noexcept {
  Turn(q, v);
  EliminateLink2(q, v);
  AssembleHub(q, v, r);
  EliminateLink1();
}

template <int M>
double ArticulatedArm<M>::Expand(const std::array<double, 2>& hub, Coordinates* a) const noexcept {
  const double th1 = hub[0], th2 = hub[1];
  const double w = over_ * (cw_ - Cw1_ * th1 - Cw2_ * th2);
  const double s = over_ * (cs_ - Cs1_ * th1 - Cs2_ * th2);
  a->th[0] = th1, a->th[1] = th2;
  a->th[3] = over4_ * (g4_ - c_.J2 * (th1 + e_ * s) + K2h_ * th2);
  const double force_w = S1w_ * th1 + S2w_ * th2 + Sww_ * w + Sws_ * s - gw_;
  const double force_s = S1s_ * th1 + S2s_ * th2 + Sws_ * w + Sss_ * s - gs_;
  const auto& x1 = k_.link1.x;
  a->f1 = (free1_ - th1 * x1[0]) - (force_w * x1[1] + force_s * x1[2]);
  const double across = ty_ * th1 + cb_ * w + Y_, turn = th1 + th2 + e_ * s + kappa_;
  const double twist = u_ * turn;
  const double phi2_s = z_s2_ - across * k_.X2(0, 2) - turn * k_.X2(1, 2) - twist * k_.X2(2, 2);
  const auto& x2 = k_.link2.x;
  a->f2 = (free2_ - across * x2[0]) - (turn * x2[1] + (twist + tip2_ + phi_ * phi2_s) * x2[2]);
  return s;
}

}  // namespace flexarm
