#pragma once

// Bodies of rigid_joint_arm.h, which includes this at its end.

#include <cmath>

namespace flexarm {

// Forces by the velocities of three bodies: the elbow along and across link 2 (x, y), and the
// rotation of hub 2 (g). Each is a row over [th1 th2 phi1_1 phi1_2]' plus a part due to the rates
// alone. Names as in arm_equations.h; rotor 2 turns with hub 2 here, so J2 is in I2.
template <typename Math>
RigidJointArm::Inertia RigidJointArm::At(const OutboardBody& body, const Vector& q,
                                         const Vector& v) const noexcept {
  using Eigen::Vector2d, Eigen::Vector4d;
  const Vector2d f1 = q.segment<2>(2), f2 = q.tail<2>();
  const Vector2d f1_dot = v.segment<2>(2), f2_dot = v.tail<2>();
  const double th1_dot = v[0];

  // Tips: deflection and slope of link 1, slope of link 2; tan(alpha) = s.
  const double w = p1_.dot(f1), w_dot = p1_.dot(f1_dot);
  const double s = s1_.dot(f1), e = 1.0 / (1.0 + s * s), alpha_dot = e * s1_.dot(f1_dot);
  const double s2 = s2_.dot(f2), e2 = 1.0 / (1.0 + s2 * s2), alpha2_dot = e2 * s2_.dot(f2_dot);
  const double root = std::sqrt(e);
  const SineCosine th2 = Math::SinCos(q[1]);
  const double sb = root * (th2.sine + s * th2.cosine), cb = root * (th2.cosine - s * th2.sine);

  const Vector4d x(sb * L1_ - cb * w, 0.0, sb * p1_[0], sb * p1_[1]);
  const Vector4d y(cb * L1_ + sb * w, 0.0, cb * p1_[0], cb * p1_[1]);
  const Vector4d turn(1.0, 0.0, e * s1_[0], e * s1_[1]);  // end of link 1
  const Vector4d g = turn + Vector4d::Unit(1);
  const Vector2d p = e2 * s2_;  // payload against hub 2

  const Vector2d N1f1 = N1_ * f1, N2f2 = body.N2 * f2;
  const double Sy = body.k2.dot(f2), I = body.I2 + f2.dot(N2f2) + Ip_;

  Inertia out;
  const Vector4d F_x = body.m * x - Sy * g, F_y = body.m * y + body.Sx * g;
  const Vector4d T_g = body.Sx * y - Sy * x + I * g;
  out.M.topLeftCorner<4, 4>() = x * F_x.transpose() + y * F_y.transpose() + g * T_g.transpose() +
                                Ir2_ * turn * turn.transpose();
  out.M(0, 0) += I1_ + f1.dot(N1f1);
  out.M.block<2, 1>(2, 0) += a1_;
  out.M.block<1, 2>(0, 2) += a1_.transpose();
  out.M.block<2, 2>(2, 2) += N1_;
  out.M.bottomLeftCorner<2, 4>() = body.k2 * y.transpose() + (body.a2 + Ip_ * p) * g.transpose();
  out.M.topRightCorner<4, 2>() = out.M.bottomLeftCorner<2, 4>().transpose();
  out.M.bottomRightCorner<2, 2>() = body.N2 + Ip_ * p * p.transpose();

  // Accelerations due to the rates alone: elbow in frame 1, then in frame 2; hub 2; payload.
  const double x1 = -2.0 * th1_dot * w_dot - th1_dot * th1_dot * L1_, y1 = -th1_dot * th1_dot * w;
  const double X = cb * x1 + sb * y1, Y = cb * y1 - sb * x1;
  const double gamma_dot = th1_dot + v[1] + alpha_dot;
  const double kappa = -2.0 * s * alpha_dot * alpha_dot;
  const double P = Ip_ * (kappa - 2.0 * s2 * alpha2_dot * alpha2_dot);
  const double R = Ir2_ * kappa;

  const double f_x = body.m * X - Sy * kappa - gamma_dot * gamma_dot * body.Sx -
                     2.0 * gamma_dot * body.k2.dot(f2_dot);
  const double f_y = body.m * Y + body.Sx * kappa - gamma_dot * gamma_dot * Sy;
  const double t_g =
      body.Sx * Y - Sy * X + (I - Ip_) * kappa + P + 2.0 * gamma_dot * N2f2.dot(f2_dot);
  const double f_x1 = cb * f_x - sb * f_y, f_y1 = sb * f_x + cb * f_y;
  out.bias[0] = 2.0 * th1_dot * N1f1.dot(f1_dot) - w * f_x1 + L1_ * f_y1 + t_g + R;
  out.bias[1] = t_g;
  out.bias.segment<2>(2) = f_y1 * p1_ - th1_dot * th1_dot * N1f1 + (e * (t_g + R)) * s1_;
  out.bias.tail<2>() = Y * body.k2 + kappa * body.a2 - gamma_dot * gamma_dot * N2f2 + P * p;
  return out;
}

}  // namespace flexarm
