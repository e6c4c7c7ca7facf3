#include "controller/planner/plan_cost.h"

#include <algorithm>

namespace flexarm {
namespace {

constexpr std::size_t kPathBeyondStages = 3;  // one before the first stage, two after the last

}  // namespace

void PlanCost::Set(const RigidJointArm& arm, double period_s, const PlanWeights& weights,
                   const PlanProblem& problem) noexcept {
  const std::size_t points = problem.path.size();
  stages_ = points < kPathBeyondStages
                ? 0
                : std::min(points - kPathBeyondStages, HorizonPlan::kMaxStages);
  if (stages_ == 0) return;

  const double ratio = problem.payload_kg / weights.light_kg;
  moving_ = PlanState::Map(weights.moving.data()) / (1.0 + ratio * ratio);
  resting_ = PlanState::Map(weights.resting.data());
  torque_weight_ = Eigen::Vector2d::Map(weights.torque.data());
  move_samples_ = problem.move_samples;

  const OutboardBody body = arm.Outboard(problem.payload_kg),
                     reference = arm.Outboard(weights.reference_payload_kg);
  const auto both = [&](std::size_t i) -> std::array<QuasiStaticPose, 2> {
    return {QuasiStaticAt(arm, body, problem.path[i]),
            QuasiStaticAt(arm, reference, problem.path[i])};
  };
  // Path index and sample index differ by one. Each pose is computed once and reused.
  std::array<QuasiStaticPose, 2> before = both(0), now = both(1);
  for (std::size_t k = 0; k <= stages_; ++k) {
    const std::array<QuasiStaticPose, 2> next = both(k + 2);
    quasi_static_.x[k] << now[0].q, (next[0].q - before[0].q) / (2.0 * period_s);
    if (k < stages_) quasi_static_.torque_nm[k] = now[0].torque_nm;
    reference_[k].setZero();
    reference_[k].head<2>() = now[1].q.head<2>();
    reference_[k].segment<2>(6) = (next[1].q - before[1].q).head<2>() / (2.0 * period_s);
    before = now;
    now = next;
  }
}

double PlanCost::Cost(const PlanTrajectory& track) const noexcept {
  double cost = 0.0;
  for (std::size_t k = 0; k <= stages_; ++k) {
    const PlanState dx = track.x[k] - reference_[k];
    cost += dx.dot(StateWeight(k).cwiseProduct(dx));
    if (k == stages_) break;
    const Eigen::Vector2d du = track.torque_nm[k] - quasi_static_.torque_nm[k];
    cost += du.dot(torque_weight_.cwiseProduct(du));
  }
  return cost;
}

}  // namespace flexarm
