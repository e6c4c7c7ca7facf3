#include "model/rigid_joint/quasi_static_map.h"

#include "model/math/small_cholesky.h"

namespace flexarm {
namespace {

using Vector = RigidJointArm::Vector;

Vector OfHubs(const std::array<double, 2>& hubs) noexcept {
  Vector out = Vector::Zero();
  out.head<2>() = Eigen::Vector2d::Map(hubs.data());
  return out;
}

}  // namespace

QuasiStaticPose QuasiStaticAt(const RigidJointArm& arm, const OutboardBody& body,
                              const RigidPoint& point) noexcept {
  const Vector v = OfHubs(point.rate_rad_s), a = OfHubs(point.acceleration_rad_s2);
  const RigidJointArm::Inertia at = arm.At(body, OfHubs(point.angle_rad), v);
  const Vector g = at.M.lazyProduct(a) + at.bias + arm.damping().lazyProduct(v);

  const SmallCholesky<4> K_ff(arm.stiffness().bottomRightCorner<4, 4>());
  const SmallCholesky<2> M_tt(at.M.topLeftCorner<2, 2>());
  const Eigen::Vector4d g_f = g.tail<4>(), f = -K_ff.Solve(g_f);
  const Eigen::Vector2d M_tf_f = at.M.topRightCorner<2, 4>().lazyProduct(f);

  QuasiStaticPose out;
  out.q << Eigen::Vector2d::Map(point.angle_rad.data()) - M_tt.Solve(M_tf_f), f;
  out.torque_nm = g.head<2>();
  return out;
}

MotionSample QuasiStaticOver(const RigidJointArm& arm, double payload_kg,
                             const std::array<RigidPoint, 3>& previous_now_next,
                             double period_s) noexcept {
  const OutboardBody body = arm.Outboard(payload_kg);
  const QuasiStaticPose previous = QuasiStaticAt(arm, body, previous_now_next[0]);
  const QuasiStaticPose now = QuasiStaticAt(arm, body, previous_now_next[1]);
  const QuasiStaticPose next = QuasiStaticAt(arm, body, previous_now_next[2]);
  Eigen::Matrix<double, 12, 1> x;
  x << now.q, (next.q - previous.q) / (2.0 * period_s);
  return MotionSample::Of(x, 0.5 * (now.torque_nm + next.torque_nm));
}

}  // namespace flexarm
