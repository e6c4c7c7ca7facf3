#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "model/arm/arm_constants.h"
#include "model/arm/shortened_link.h"

namespace flexarm {

template <typename Scalar>
using VectorX = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

/// Inertial forces M(q) a + bias(q, v) of the arm, from the kinetic energy (3.19) in compact form.
///
/// Recursive Newton-Euler form: velocities and accelerations from the shoulder outwards, forces
/// back inwards; no mass matrix and no derivative of one is formed. Misprints of (3.19) corrected:
/// the second I_r2 is J2, I_r1 is J1. Frames: 1 turns with th1, 2 with gamma = th1 + alpha1 + th2,
/// where tan(alpha1) = s = w1'(L1). Everything outboard of the elbow is one flexible body in
/// frame 2. Source: thesis (3.14)-(3.21), derived again (Appendix A has misprints). With
/// foreshortening, which the thesis does not model, each link adds the terms of ShortenedLink.
/// Scalar: double, or std::complex<double> for derivatives by the complex step: the body must not
/// use abs, conjugation or comparison.
/// @param q, v, a  dof vectors: angles rad, modal coordinates m, and their derivatives
/// @returns generalised forces, N m for angles, N for modal coordinates
template <typename Scalar>
VectorX<Scalar> InertialForces(const ArmConstants& c, const VectorX<Scalar>& q,
                               const VectorX<Scalar>& v, const VectorX<Scalar>& a) {
  using std::cos, std::sin, std::sqrt;
  using Vector = VectorX<Scalar>;
  // NOLINTNEXTLINE(readability-const-return-type): Eigen's return type, a reference if possible
  const auto cast = [](const auto& x) -> decltype(auto) { return x.template cast<Scalar>(); };
  const auto dot = [&](const Eigen::VectorXd& x, const Vector& y) {
    return (cast(x).array() * y.array()).sum();
  };
  const Vector f1 = q.segment(kPhi1, c.m1), f1_dot = v.segment(kPhi1, c.m1),
               f1_ddot = a.segment(kPhi1, c.m1);
  const Vector f2 = q.tail(c.m2), f2_dot = v.tail(c.m2), f2_ddot = a.tail(c.m2);
  const Eigen::VectorXd &slope1 = c.link1.slope_tip, &slope2 = c.link2.slope_tip;
  const Vector N1f1 = cast(c.link1.N) * f1, N2f2 = cast(c.N2) * f2;

  // Tip of link 1: deflection w, slope s, tangent angle alpha = atan(s).
  const Scalar w = dot(c.link1.psi_tip, f1), w_dot = dot(c.link1.psi_tip, f1_dot);
  const Scalar s = dot(slope1, f1), s_dot = dot(slope1, f1_dot);
  const Scalar e = 1.0 / (1.0 + s * s);
  const Scalar alpha_dot = e * s_dot;
  const Scalar alpha_ddot = e * dot(slope1, f1_ddot) - 2.0 * s * alpha_dot * alpha_dot;
  const Scalar s_2 = sin(q[kTheta2]), c_2 = cos(q[kTheta2]), root = sqrt(e);
  const Scalar sb = root * (s_2 + s * c_2), cb = root * (c_2 - s * s_2);  // of beta = alpha + th2

  // Elbow acceleration in frame 1, then in frame 2; rates of hub 2.
  const Scalar w1 = v[kTheta1];
  Scalar x1 = -a[kTheta1] * w - 2.0 * w1 * w_dot - w1 * w1 * c.L1;
  Scalar y1 = a[kTheta1] * c.L1 + dot(c.link1.psi_tip, f1_ddot) - w1 * w1 * w;
  std::optional<ShortenedLink<Scalar, Eigen::Dynamic>> short1, short2;
  if (c.foreshortening) {
    short1.emplace(c.shortening1, f1, f1_dot, f1_ddot);
    short2.emplace(c.shortening2, f2, f2_dot, f2_ddot);
    x1 += w1 * w1 * short1->tip - short1->tip_ddot;
    y1 -= a[kTheta1] * short1->tip + 2.0 * w1 * short1->tip_dot;
  }
  const Scalar X = cb * x1 + sb * y1, Y = -sb * x1 + cb * y1;
  const Scalar g = w1 + v[kTheta2] + alpha_dot;  // gamma_dot
  const Scalar g_ddot = a[kTheta1] + a[kTheta2] + alpha_ddot;

  // Payload turns with gamma + alpha2, tan(alpha2) = s2 = w2'(L2).
  const Scalar s2 = dot(slope2, f2), e2 = 1.0 / (1.0 + s2 * s2);
  const Scalar alpha2_dot = e2 * dot(slope2, f2_dot);
  const Scalar alpha2_ddot = e2 * dot(slope2, f2_ddot) - 2.0 * s2 * alpha2_dot * alpha2_dot;
  const Scalar P = c.Ip * (g_ddot + alpha2_ddot);

  // Outboard body: force and moment at the elbow in frame 2, and modal forces of link 2.
  const Scalar Sy = dot(c.k2, f2);
  const Scalar f2N2f2_dot = (N2f2.array() * f2_dot.array()).sum();
  Scalar F_x = c.m_outboard * X - Sy * g_ddot - g * g * c.Sx - 2.0 * g * dot(c.k2, f2_dot);
  Scalar F_y = c.m_outboard * Y + c.Sx * g_ddot + dot(c.k2, f2_ddot) - g * g * Sy;
  Scalar T_g = -Sy * X + c.Sx * Y + (c.I2 + (N2f2.array() * f2.array()).sum()) * g_ddot +
               dot(c.a2, f2_ddot) + 2.0 * g * f2N2f2_dot + P;
  if (short2) {
    F_x += g * g * short2->k - short2->k_ddot;
    F_y -= g_ddot * short2->k + 2.0 * g * short2->k_dot;
    T_g += short2->second_moment * g_ddot + short2->turning + 2.0 * g * short2->half_rate -
           short2->k * Y;
  }
  const Scalar R = c.Ir2 * (a[kTheta1] + alpha_ddot);              // stator of motor 2
  const Scalar J = c.J2 * (a[kTheta1] + alpha_ddot + a[kTheta4]);  // rotor of motor 2

  Vector out(c.dof());
  const Scalar f_x1 = cb * F_x - sb * F_y, f_y1 = sb * F_x + cb * F_y;
  const Scalar f1N1f1_dot = (N1f1.array() * f1_dot.array()).sum();
  out[kTheta1] = (c.I1 + (N1f1.array() * f1.array()).sum()) * a[kTheta1] + dot(c.link1.a, f1_ddot) +
                 2.0 * w1 * f1N1f1_dot - w * f_x1 + c.L1 * f_y1 + T_g + R + J;
  out[kTheta2] = T_g;
  out[kTheta3] = c.J1 * a[kTheta3];
  out[kTheta4] = J;
  out.segment(kPhi1, c.m1) = cast(c.link1.a) * a[kTheta1] + cast(c.link1.N) * f1_ddot -
                             w1 * w1 * N1f1 + cast(c.link1.psi_tip) * f_y1 +
                             cast(slope1) * (e * (T_g + R + J));
  out.tail(c.m2) = cast(c.k2) * Y + cast(c.a2) * g_ddot + cast(c.N2) * f2_ddot - g * g * N2f2 +
                   cast(slope2) * (e2 * P);
  if (short1) {
    out[kTheta1] += short1->second_moment * a[kTheta1] + short1->turning +
                    2.0 * w1 * short1->half_rate - short1->tip * f_y1;
    out.segment(kPhi1, c.m1) += short1->Forces(w1, a[kTheta1]) - short1->tip_slope * f_x1;
    out.tail(c.m2) += short2->Forces(g, g_ddot) - short2->k_slope * X;
  }
  return out;
}

}  // namespace flexarm
