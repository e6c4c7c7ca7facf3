#include "controller/planner/backward_pass.h"

#include "model/math/column_sum.h"
#include "model/math/small_cholesky.h"
#include "model/math/wide_instructions.h"
#include "model/rigid_joint/rigid_joint_transition.h"

namespace flexarm {
namespace {

using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Matrix2x12 = Eigen::Matrix<double, 2, 12>;

}  // namespace

FLEXARM_WIDE_INSTRUCTIONS
void BackwardPass(const RigidJointStepper& stepper, double payload_kg, const PlanCost& targets,
                  const PlanTrajectory& track, PlanPolicy* policy) noexcept {
  const std::size_t stages = targets.stages();
  const auto slope = [&](std::size_t k) -> PlanState {
    return targets.StateWeight(k).cwiseProduct(track.x[k] - targets.Reference(k));
  };
  // Cost-to-go from sample k + 1: dx'V dx / 2 + v'dx.
  Matrix12 V = targets.StateWeight(stages).asDiagonal();
  PlanState v = slope(stages);
  for (std::size_t k = stages; k-- > 0;) {
    const PlanState middle = 0.5 * (track.x[k] + track.x[k + 1]);
    const PlanState mean_rate = (track.x[k + 1] - track.x[k]) / stepper.period_s();
    const auto [A, B] = MotionTransitionOver(stepper, payload_kg, middle.head<6>(),
                                             middle.tail<6>(), mean_rate.tail<6>());

    const Matrix12 VA = ColumnProduct(V, A), A_turned = A.transpose();
    const Matrix2x12 Q_ux = B.transpose().lazyProduct(VA);
    const Matrix2x12 BtV = B.transpose().lazyProduct(V);
    Eigen::Matrix2d Q_uu = BtV.lazyProduct(B);
    Q_uu.diagonal() += targets.TorqueWeight();
    const Eigen::Vector2d Q_u = targets.TorqueWeight().cwiseProduct(
                                    track.torque_nm[k] - targets.quasi_static().torque_nm[k]) +
                                B.transpose().lazyProduct(v);

    const SmallCholesky<2> Q_uu_factor(Q_uu);
    const Matrix2x12 K = -Q_uu_factor.Solve(Q_ux);
    policy->K[k] = K;
    policy->step_nm[k] = -Q_uu_factor.Solve(Q_u);

    const PlanState v_next = v;
    v = slope(k) + A.transpose().lazyProduct(v_next) +
        Q_ux.transpose().lazyProduct(policy->step_nm[k]);
    const Matrix12 W = ColumnProduct(A_turned, VA) + Q_ux.transpose().lazyProduct(K);
    V = 0.5 *
        (W + W.transpose());  // removes round-off asymmetry, which the recursion would amplify
    V.diagonal() += targets.StateWeight(k);
  }
}

}  // namespace flexarm
