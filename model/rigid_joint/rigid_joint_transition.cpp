#include "model/rigid_joint/rigid_joint_transition.h"

#include <Eigen/LU>
#include <bit>

#include "model/math/column_sum.h"
#include "model/math/wide_instructions.h"

namespace flexarm {
namespace {

using Vector = RigidJointArm::Vector;
using Matrix = RigidJointArm::Matrix;

constexpr double kDifference = 1e-6;  // rad, m, rad/s, m/s

struct Slopes {
  Matrix M;
  Matrix by_q, by_v;  // of g(q, v) = M(q) a + bias(q, v)
};

// g at (q, v) and at the 11 places beside it that count, four at once.
Slopes SlopesAt(const RigidJointArm& arm, double payload_kg, const Vector& q, const Vector& v,
                const Vector& a) noexcept {
  constexpr int n = RigidJointArm::kDof;
  using Four = RigidJointArm::VectorOf<Lanes>;
  const OutboardBodyOf<Lanes> body = arm.OutboardOf(Lanes(payload_kg));
  Slopes out;
  Eigen::Matrix<double, n, 2 * n> g;  // at (q, v), then with a change of q from phi1_1 on, and of v
  for (int first = 0; first < 2 * n; first += 4) {
    Four q_near, v_near;
    for (int i = 0; i < n; ++i) {
      q_near[i] = q[i];
      v_near[i] = v[i];
    }
    for (int lane = first == 0 ? 1 : 0; lane < 4; ++lane) {
      const int i = first + lane;
      Lanes& changed = i < n ? q_near[i] : v_near[i - n];
      const auto at = static_cast<std::size_t>(lane);
      changed.Set(at, changed[at] + kDifference);
    }
    const RigidJointArm::InertiaOf<Lanes> near = arm.At(body, q_near, v_near);
    for (int row = 0; row < n; ++row) {
      Lanes sum = near.bias[row];
      for (int i = 0; i < n; ++i) sum += near.M(row, i) * a[i];
      for (int lane = 0; lane < 4; ++lane) {
        g(row, first + lane) = sum[static_cast<std::size_t>(lane)];
      }
      if (first > 0) continue;
      for (int i = 0; i < n; ++i) out.M(row, i) = near.M(row, i)[0];
    }
  }
  out.by_q.col(0).setZero();
  for (int i = 1; i < n; ++i) out.by_q.col(i) = (g.col(i) - g.col(0)) / kDifference;
  for (int i = 0; i < n; ++i) out.by_v.col(i) = (g.col(n + i) - g.col(0)) / kDifference;
  return out;
}

// [Phi G] of a step or several: the columns of q and q', then those of the forces. phi_f depends on
// itself by gauge_kept alone. kRows: 12, or 16 with phi_f.
template <int kRows, int kForces>
struct Steps {
  static constexpr int kMoving = 2 * RigidJointArm::kDof;
  static constexpr int kColumns = kMoving + kForces;
  Eigen::Matrix<double, kRows, kColumns> of;
  double gauge_kept;

  // Phi <- Phi Phi, G <- G + Phi G. th1 acts on nothing, so its column stays.
  void Double() noexcept {
    Eigen::Matrix<double, kRows, kColumns> twice;
    twice.col(0) = of.col(0);
    for (int column = 1; column < kColumns; ++column) {
      ColumnSum<kRows> sum;
      if (column >= kMoving) sum.Add(1.0, &of(0, column));
      for (int k = 0; k < kMoving; ++k) sum.Add(of(k, column), &of(0, k));
      sum.WriteTo(&twice(0, column));
      for (int row = kMoving; row < kRows; ++row) {
        twice(row, column) += gauge_kept * of(row, column);
      }
    }
    of = twice;
    gauge_kept *= gauge_kept;
  }
};

template <int kRows, int kForces>
Steps<kRows, kForces> StepsOver(const RigidJointStepper& stepper, double payload_kg,
                                const Vector& q, const Vector& v, const Vector& a) noexcept {
  constexpr Eigen::Index n = RigidJointArm::kDof;
  const RigidJointArm& arm = stepper.arm();
  const double h = stepper.step_s();
  const Slopes slopes = SlopesAt(arm, payload_kg, q, v, a);
  const Matrix D = arm.damping() + slopes.by_v, K = arm.stiffness() + slopes.by_q;

  // Accelerations of one step by [q v F]: (M + h/2 D + h^2/4 K) a = F - D v - K (q + h/2 v).
  const Matrix A = slopes.M + 0.5 * h * D + 0.25 * h * h * K;
  const Matrix by_F = A.inverse();
  const Matrix by_q = -by_F.lazyProduct(K);
  const Matrix by_v = -by_F.lazyProduct(D + 0.5 * h * K);

  const Matrix I = Matrix::Identity();
  const double half = 0.5 * h * h, share = stepper.gauge_share();
  Steps<kRows, kForces> steps;
  steps.of.template block<n, n>(0, 0) = I + half * by_q;
  steps.of.template block<n, n>(0, n) = h * I + half * by_v;
  steps.of.template block<n, n>(n, 0) = h * by_q;
  steps.of.template block<n, n>(n, n) = I + h * by_v;
  steps.of.template block<n, kForces>(0, 2 * n) = half * by_F.leftCols<kForces>();
  steps.of.template block<n, kForces>(n, 2 * n) = h * by_F.leftCols<kForces>();
  steps.gauge_kept = 1.0 - share;
  if constexpr (kRows > 2 * n) {
    // phi_f moves towards phi of the middle: the mean of the step's ends, less h^2/4 of a.
    const Matrix middle_q = I + 0.5 * half * by_q, middle_v = 0.5 * h * I + 0.5 * half * by_v;
    steps.of.template block<4, n>(2 * n, 0) = share * middle_q.bottomRows<4>();
    steps.of.template block<4, n>(2 * n, n) = share * middle_v.bottomRows<4>();
    steps.of.template block<4, kForces>(2 * n, 2 * n) =
        0.5 * share * half * by_F.bottomLeftCorner<4, kForces>();
  }
  const int doublings = std::countr_zero(static_cast<unsigned>(stepper.steps()));
  for (int i = 0; i < doublings; ++i) steps.Double();
  return steps;
}

}  // namespace

FLEXARM_WIDE_INSTRUCTIONS
Transition TransitionOver(const RigidJointStepper& stepper, double payload_kg, const Vector& q,
                          const Vector& v, const Vector& a) noexcept {
  const Steps<16, 6> steps = StepsOver<16, 6>(stepper, payload_kg, q, v, a);
  return {.by_motion = steps.of.leftCols<12>(),
          .gauge_kept = steps.gauge_kept,
          .G = steps.of.rightCols<6>()};
}

FLEXARM_WIDE_INSTRUCTIONS
MotionTransition MotionTransitionOver(const RigidJointStepper& stepper, double payload_kg,
                                      const Vector& q, const Vector& v, const Vector& a) noexcept {
  const Steps<12, 2> steps = StepsOver<12, 2>(stepper, payload_kg, q, v, a);
  return {.Phi = steps.of.leftCols<12>(), .G = steps.of.rightCols<2>()};
}

}  // namespace flexarm
