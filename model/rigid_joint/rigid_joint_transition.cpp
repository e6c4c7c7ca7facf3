#include "model/rigid_joint/rigid_joint_transition.h"

#include <Eigen/LU>
#include <bit>

namespace flexarm {
namespace {

using Vector = RigidJointArm::Vector;
using Matrix = RigidJointArm::Matrix;

constexpr double kDifference = 1e-6;  // rad, m, rad/s, m/s

struct Slopes {
  Matrix M;
  Matrix by_q, by_v;  // of g(q, v) = M(q) a + bias(q, v)
};

Slopes SlopesAt(const RigidJointArm& arm, const OutboardBody& body, const Vector& q,
                const Vector& v, const Vector& a) noexcept {
  const RigidJointArm::Inertia at = arm.At(body, q, v);
  const Vector g = at.M.lazyProduct(a) + at.bias;
  const auto slope = [&](const Vector& q_1, const Vector& v_1) -> Vector {
    const RigidJointArm::Inertia moved = arm.At(body, q_1, v_1);
    return (moved.M.lazyProduct(a) + moved.bias - g) / kDifference;
  };
  Slopes out;
  out.M = at.M;
  out.by_q.col(0).setZero();
  for (int i = 1; i < RigidJointArm::kDof; ++i) {
    out.by_q.col(i) = slope(q + kDifference * Vector::Unit(i), v);
  }
  for (int i = 0; i < RigidJointArm::kDof; ++i) {
    out.by_v.col(i) = slope(q, v + kDifference * Vector::Unit(i));
  }
  return out;
}

}  // namespace

Transition TransitionOver(const RigidJointStepper& stepper, double payload_kg, const Vector& q,
                          const Vector& v, const Vector& a) noexcept {
  constexpr Eigen::Index n = RigidJointArm::kDof;
  const RigidJointArm& arm = stepper.arm();
  const double h = stepper.step_s();
  const Slopes slopes = SlopesAt(arm, arm.Outboard(payload_kg), q, v, a);
  const Matrix D = arm.damping() + slopes.by_v, K = arm.stiffness() + slopes.by_q;

  // Accelerations of one step by [q v F]: (M + h/2 D + h^2/4 K) a = F - D v - K (q + h/2 v).
  const Matrix A = slopes.M + 0.5 * h * D + 0.25 * h * h * K;
  const Matrix by_F = A.inverse();
  const Matrix by_q = -by_F.lazyProduct(K);
  const Matrix by_v = -by_F.lazyProduct(D + 0.5 * h * K);

  const Matrix I = Matrix::Identity();
  const double half = 0.5 * h * h, share = stepper.gauge_share();
  Transition step;
  step.Phi.setZero();
  step.Phi.topLeftCorner<n, n>() = I + half * by_q;
  step.Phi.block<n, n>(0, n) = h * I + half * by_v;
  step.Phi.block<n, n>(n, 0) = h * by_q;
  step.Phi.block<n, n>(n, n) = I + h * by_v;
  step.G.topRows<n>() = half * by_F;
  step.G.middleRows<n>(n) = h * by_F;
  // phi_f moves towards phi of the middle: the mean of the step's ends, less h^2/4 of a.
  const Matrix middle_q = I + 0.5 * half * by_q, middle_v = 0.5 * h * I + 0.5 * half * by_v;
  step.Phi.block<4, n>(2 * n, 0) = share * middle_q.bottomRows<4>();
  step.Phi.block<4, n>(2 * n, n) = share * middle_v.bottomRows<4>();
  step.Phi.bottomRightCorner<4, 4>().diagonal().setConstant(1.0 - share);
  step.G.bottomRows<4>() = 0.5 * share * half * by_F.bottomRows<4>();

  const int doublings = std::countr_zero(static_cast<unsigned>(stepper.steps()));
  for (int i = 0; i < doublings; ++i) {
    Transition twice;
    twice.G = step.G + step.Phi.lazyProduct(step.G);
    twice.Phi = step.Phi.lazyProduct(step.Phi);
    step = twice;
  }
  return step;
}

}  // namespace flexarm
