#pragma once

// Bodies of rigid_joint_arm.h, which includes this at its end. Written entry by entry: that serves
// any scalar, leaves out zeros, and computes one half of what is symmetric.

#include <cmath>

namespace flexarm {

template <typename Scalar>
OutboardBodyOf<Scalar> RigidJointArm::OutboardOf(const Scalar& payload_kg) const noexcept {
  const auto with = [&payload_kg](double empty, double per_kg) -> Scalar {
    return empty + payload_kg * per_kg;
  };
  OutboardBodyOf<Scalar> body;
  body.m = with(empty_.m, per_kg_.m);
  body.Sx = with(empty_.Sx, per_kg_.Sx);
  body.I2 = with(empty_.I2, per_kg_.I2);
  for (int i = 0; i < 2; ++i) {
    body.k2[i] = with(empty_.k2[i], per_kg_.k2[i]);
    body.a2[i] = with(empty_.a2[i], per_kg_.a2[i]);
    for (int j = 0; j < 2; ++j) body.N2(i, j) = with(empty_.N2(i, j), per_kg_.N2(i, j));
  }
  return body;
}

// Forces by the velocities of three bodies: the elbow along and across link 2 (x, y), the end of
// link 1 (turn) and hub 2 (g). Each is a row over [th1 th2 phi1_1 phi1_2]' plus a part due to the
// rates alone. Names as in arm_equations.h; rotor 2 turns with hub 2 here, so J2 is in I2.
template <typename Math, typename Scalar>
RigidJointArm::InertiaOf<Scalar> RigidJointArm::At(
    const OutboardBodyOf<Scalar>& body, const std::type_identity_t<VectorOf<Scalar>>& q,
    const std::type_identity_t<VectorOf<Scalar>>& v) const noexcept {
  using std::sqrt;
  const Scalar f11 = q[2], f12 = q[3], f21 = q[4], f22 = q[5];
  const Scalar f11_dot = v[2], f12_dot = v[3], f21_dot = v[4], f22_dot = v[5];
  const Scalar th1_dot = v[0];

  // Tips: deflection and slope of link 1, slope of link 2; tan(alpha) = s.
  const Scalar w = p1_[0] * f11 + p1_[1] * f12, w_dot = p1_[0] * f11_dot + p1_[1] * f12_dot;
  const Scalar s = s1_[0] * f11 + s1_[1] * f12, e = 1.0 / (1.0 + s * s);
  const Scalar alpha_dot = e * (s1_[0] * f11_dot + s1_[1] * f12_dot);
  const Scalar s2 = s2_[0] * f21 + s2_[1] * f22, e2 = 1.0 / (1.0 + s2 * s2);
  const Scalar alpha2_dot = e2 * (s2_[0] * f21_dot + s2_[1] * f22_dot);
  const Scalar root = sqrt(e);
  const auto th2 = Math::SinCos(q[1]);
  const Scalar sb = root * (th2.sine + s * th2.cosine), cb = root * (th2.cosine - s * th2.sine);

  // Of [th1 phi1_1 phi1_2]; that of th2 is 0 for x, y and turn, and 1 for g, whose rest is turn.
  using Two = Eigen::Matrix<Scalar, 2, 1>;
  using Three = Eigen::Matrix<Scalar, 3, 1>;
  const Three x(sb * L1_ - cb * w, sb * p1_[0], sb * p1_[1]);
  const Three y(cb * L1_ + sb * w, cb * p1_[0], cb * p1_[1]);
  const Three turn(Scalar(1.0), e * s1_[0], e * s1_[1]);
  const Two p(e2 * s2_[0], e2 * s2_[1]);  // payload against hub 2

  const Two N1f1(N1_(0, 0) * f11 + N1_(0, 1) * f12, N1_(1, 0) * f11 + N1_(1, 1) * f12);
  const Two N2f2(body.N2(0, 0) * f21 + body.N2(0, 1) * f22,
                 body.N2(1, 0) * f21 + body.N2(1, 1) * f22);
  const Scalar Sy = body.k2[0] * f21 + body.k2[1] * f22;
  const Scalar I = body.I2 + f21 * N2f2[0] + f22 * N2f2[1] + Ip_;

  InertiaOf<Scalar> out;
  const auto at = [](int j) { return j == 0 ? 0 : j + 1; };  // of x, y, turn among the coordinates
  MatrixOf<Scalar>& M = out.M;
  M(1, 1) = I;
  for (int j = 0; j < 3; ++j) {
    const Scalar F_x = body.m * x[j] - Sy * turn[j], F_y = body.m * y[j] + body.Sx * turn[j];
    const Scalar T_g = body.Sx * y[j] - Sy * x[j] + I * turn[j], T = T_g + Ir2_ * turn[j];
    for (int i = j; i < 3; ++i) M(at(i), at(j)) = x[i] * F_x + y[i] * F_y + turn[i] * T;
    j == 0 ? M(1, 0) = T_g : M(at(j), 1) = T_g;
  }
  M(0, 0) += I1_ + (f11 * N1f1[0] + f12 * N1f1[1]);
  for (int i = 0; i < 2; ++i) {
    M(2 + i, 0) += a1_[i];
    for (int j = 0; j <= i; ++j) M(2 + i, 2 + j) += N1_(i, j);
    const Scalar by_turn = body.a2[i] + Ip_ * p[i];
    M(4 + i, 1) = by_turn;
    for (int j = 0; j < 3; ++j) M(4 + i, at(j)) = body.k2[i] * y[j] + by_turn * turn[j];
    for (int j = 0; j <= i; ++j) M(4 + i, 4 + j) = body.N2(i, j) + Ip_ * p[i] * p[j];
  }
  for (int i = 1; i < kDof; ++i) {
    for (int j = 0; j < i; ++j) M(j, i) = M(i, j);
  }

  // Accelerations due to the rates alone: elbow in frame 1, then in frame 2; hub 2; payload.
  const Scalar turned = th1_dot * th1_dot;
  const Scalar x1 = -2.0 * th1_dot * w_dot - turned * L1_, y1 = -turned * w;
  const Scalar X = cb * x1 + sb * y1, Y = cb * y1 - sb * x1;
  const Scalar gamma_dot = th1_dot + v[1] + alpha_dot, squared = gamma_dot * gamma_dot;
  const Scalar kappa = -2.0 * s * alpha_dot * alpha_dot;
  const Scalar P = Ip_ * (kappa - 2.0 * s2 * alpha2_dot * alpha2_dot);
  const Scalar R = Ir2_ * kappa;

  const Scalar f_x = body.m * X - Sy * kappa - squared * body.Sx -
                     2.0 * gamma_dot * (body.k2[0] * f21_dot + body.k2[1] * f22_dot);
  const Scalar f_y = body.m * Y + body.Sx * kappa - squared * Sy;
  const Scalar t_g = body.Sx * Y - Sy * X + (I - Ip_) * kappa + P +
                     2.0 * gamma_dot * (N2f2[0] * f21_dot + N2f2[1] * f22_dot);
  const Scalar f_x1 = cb * f_x - sb * f_y, f_y1 = sb * f_x + cb * f_y;
  out.bias[0] =
      2.0 * th1_dot * (N1f1[0] * f11_dot + N1f1[1] * f12_dot) - w * f_x1 + L1_ * f_y1 + t_g + R;
  out.bias[1] = t_g;
  for (int i = 0; i < 2; ++i) {
    out.bias[2 + i] = f_y1 * p1_[i] - turned * N1f1[i] + (t_g + R) * turn[1 + i];
    out.bias[4 + i] = Y * body.k2[i] + kappa * body.a2[i] - squared * N2f2[i] + P * p[i];
  }
  return out;
}

template <typename Scalar>
RigidJointArm::VectorOf<Scalar> RigidJointArm::RestoringForce(
    const VectorOf<Scalar>& q, const VectorOf<Scalar>& v) const noexcept {
  VectorOf<Scalar> force;
  for (int hub = 0; hub < 2; ++hub) force[hub] = damping_(hub, hub) * v[hub];
  for (int i = 2; i < kDof; ++i) {
    const int first = i < 4 ? 2 : 4, second = first + 1;
    force[i] = stiffness_(i, first) * q[first] + stiffness_(i, second) * q[second] +
               damping_(i, first) * v[first] + damping_(i, second) * v[second];
  }
  return force;
}

}  // namespace flexarm
