#include "model/rigid_joint/tip_acceleration.h"

#include <cmath>

#include "model/arm/foreshortening.h"
#include "model/math/portable_math.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Coordinates = Eigen::Ref<const Eigen::VectorXd>;

// Acceleration of the point (x, y) of a frame that turns, in its axes, without that of its origin.
Vector2d Turning(double gamma_dot, double gamma_ddot, const Moving& x, const Moving& y) noexcept {
  return {x.ddot - gamma_ddot * y.x - 2.0 * gamma_dot * y.dot - gamma_dot * gamma_dot * x.x,
          y.ddot + gamma_ddot * x.x + 2.0 * gamma_dot * x.dot - gamma_dot * gamma_dot * y.x};
}

// Foreshortening of a link: quadratic in phi, so 2 B(x, y) = delta(x + y) - delta(x) - delta(y) is
// its derivative.
Moving Shortening(const Foreshortening<>& link, const Coordinates& phi, const Coordinates& phi_dot,
                  const Coordinates& phi_ddot) noexcept {
  const double at = TipShortening(link, phi), by_rate = TipShortening(link, phi_dot);
  const auto twice = [&](const Coordinates& by, double alone) {
    return TipShortening(link, ArmVector(phi + by)) - at - alone;
  };
  return {at, twice(phi_dot, by_rate),
          2.0 * by_rate + twice(phi_ddot, TipShortening(link, phi_ddot))};
}

}  // namespace

double TipAcceleration(const TipMotion& m) noexcept {
  const double s = m.slope1.x, e = 1.0 / (1.0 + s * s), root = std::sqrt(e);
  const double alpha_dot = e * m.slope1.dot;
  const double alpha_ddot = e * m.slope1.ddot - 2.0 * s * alpha_dot * alpha_dot;
  const SineCosine th2 = PortableMath::SinCos(m.theta2.x);
  const double sb = root * (th2.sine + s * th2.cosine), cb = root * (th2.cosine - s * th2.sine);

  const Vector2d elbow = Turning(m.theta1.dot, m.theta1.ddot, m.length1, m.w1);
  const Vector2d tip = Vector2d(cb * elbow[0] + sb * elbow[1], cb * elbow[1] - sb * elbow[0]) +
                       Turning(m.theta1.dot + m.theta2.dot + alpha_dot,
                               m.theta1.ddot + m.theta2.ddot + alpha_ddot, m.length2, m.w2);
  return (tip[1] - m.slope2 * tip[0]) / std::sqrt(1.0 + m.slope2 * m.slope2);
}

double TipAcceleration(const ArmModel& arm, const Coordinates& q, const Coordinates& v,
                       const Coordinates& a) noexcept {
  const Eigen::Index m1 = arm.mode_count().link1, m2 = arm.mode_count().link2;
  const LinkModes& link1 = arm.link_modes(1);
  const LinkModes& link2 = arm.link_modes(2);
  const auto phi1 = [m1](const Coordinates& x) { return x.segment(kPhi1, m1); };
  const auto phi2 = [m2](const Coordinates& x) { return x.tail(m2); };
  TipMotion motion{
      .theta1 = {q(kTheta1), v(kTheta1), a(kTheta1)},
      .theta2 = {q(kTheta2), v(kTheta2), a(kTheta2)},
      .length1 = {link1.length_m, 0.0, 0.0},
      .length2 = {link2.length_m, 0.0, 0.0},
      // Shapes have psi(L) = 1: the deflection of a tip is the sum of its modal coordinates.
      .w1 = {phi1(q).sum(), phi1(v).sum(), phi1(a).sum()},
      .w2 = {phi2(q).sum(), phi2(v).sum(), phi2(a).sum()},
      .slope1 = {link1.slope_tip.dot(phi1(q)), link1.slope_tip.dot(phi1(v)),
                 link1.slope_tip.dot(phi1(a))},
      .slope2 = link2.slope_tip.dot(phi2(q))};
  if (arm.constants().foreshortening) {
    const auto shorten = [](const Moving& by, Moving* length) {
      length->x -= by.x, length->dot -= by.dot, length->ddot -= by.ddot;
    };
    shorten(Shortening(arm.constants().shortening1, phi1(q), phi1(v), phi1(a)), &motion.length1);
    shorten(Shortening(arm.constants().shortening2, phi2(q), phi2(v), phi2(a)), &motion.length2);
  }
  return TipAcceleration(motion);
}

}  // namespace flexarm
