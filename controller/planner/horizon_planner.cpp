#include "controller/planner/horizon_planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/planner/forward_rollout.h"

namespace flexarm {
namespace {

constexpr int kRollOutSteps = 4;
constexpr double kAnyGauge_hz = 1.0;  // no gauges in a plan; any value
constexpr std::array<double, 3> kShares = {1.0, 0.4, 0.1};
constexpr int kColdRounds = 2, kWarmRounds = 1;

}  // namespace

HorizonPlanner::HorizonPlanner(const RigidJointArm& arm, double period_s, GainTable start_gains,
                               const HorizonPlannerConfig& config)
    : linear_(arm, period_s, kAnyGauge_hz),
      rolling_(arm, period_s, kAnyGauge_hz, kRollOutSteps),
      start_gains_(std::move(start_gains)),
      config_(config),
      torque_limit_nm_(config.torque_limit_nm[0], config.torque_limit_nm[1]) {}

bool HorizonPlanner::Plan(const PlanProblem& problem, const HorizonPlan* previous,
                          HorizonPlan* out) noexcept {
  targets_.Set(linear_.arm(), linear_.period_s(), config_.weights, problem);
  if (targets_.stages() == 0) return false;
  figures_.warm = previous != nullptr && MayContinue(*previous, problem);
  RollOutStart(problem, figures_.warm ? previous : nullptr);
  figures_.start_cost = figures_.cost = targets_.Cost(track_);
  if (!std::isfinite(figures_.cost)) return false;

  const int rounds = figures_.warm ? kWarmRounds : kColdRounds;
  for (int i = 0; i < rounds; ++i) {
    BackwardPass(linear_, problem.payload_kg, targets_, track_, &policy_);
    if (!Improve(problem.payload_kg)) break;
  }
  if (!IsSmooth(problem, previous)) return false;

  out->Begin(problem.first_tick, problem.payload_kg);
  for (std::size_t k = 0; k < targets_.stages(); ++k) {
    out->Append(PlanEntry::Of(MotionSample::Of(track_.x[k], track_.torque_nm[k]), policy_.K[k]));
  }
  return true;
}

bool HorizonPlanner::IsFor(const HorizonPlan& plan, double payload_kg) const noexcept {
  const double allowed_kg =
      std::max(config_.payload_change_kg, config_.payload_change_share * plan.payload_kg());
  return std::fabs(payload_kg - plan.payload_kg()) <= allowed_kg;
}

bool HorizonPlanner::MayContinue(const HorizonPlan& previous,
                                 const PlanProblem& problem) const noexcept {
  return IsFor(previous, problem.payload_kg) && previous.At(problem.first_tick).has_value();
}

// Beyond the end of the previous plan, and without a previous plan: the quasi-static motion. The
// gain table is read at its elbow angle.
void HorizonPlanner::RollOutStart(const PlanProblem& problem,
                                  const HorizonPlan* previous) noexcept {
  const PlanTrajectory& quasi_static = targets_.quasi_static();
  const auto law = [&](std::size_t k, const PlanState& x) -> Eigen::Vector2d {
    if (previous != nullptr) {
      const auto entry = previous->At(problem.first_tick + static_cast<std::int64_t>(k));
      if (entry) {
        const PlanState deviation = x - entry->motion.State();
        return entry->motion.Torque_nm() + entry->Gain().lazyProduct(deviation);
      }
    }
    const GainTable::Gain K = start_gains_.At(problem.payload_kg, quasi_static.x[k][1]);
    return quasi_static.torque_nm[k] + K.lazyProduct(quasi_static.x[k] - x);
  };
  track_.x[0] = problem.x;
  RollOut(rolling_, problem.payload_kg, targets_.stages(), torque_limit_nm_, law, &track_);
}

// Line search: the largest share of the backward pass's step that reduces the cost.
bool HorizonPlanner::Improve(double payload_kg) noexcept {
  trial_.x[0] = track_.x[0];
  for (const double share : kShares) {
    const auto law = [&](std::size_t k, const PlanState& x) -> Eigen::Vector2d {
      return track_.torque_nm[k] + share * policy_.step_nm[k] +
             policy_.K[k].lazyProduct(x - track_.x[k]);
    };
    RollOut(rolling_, payload_kg, targets_.stages(), torque_limit_nm_, law, &trial_);
    const double cost = targets_.Cost(trial_);
    if (cost < figures_.cost) {
      figures_.cost = cost;
      track_ = trial_;
      return true;
    }
  }
  return false;
}

// The design study's rule "rejected if it raises sum |u - u_prev| / u_max above .5 and above the
// old plan's" is read as the largest change from sample to sample, both joints added. A sum over
// the horizon would be above .5 in every normal move, and would reject each plan after an increase
// of the estimated payload.
bool HorizonPlanner::IsSmooth(const PlanProblem& problem,
                              const HorizonPlan* previous) const noexcept {
  const auto change = [this](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return (to - from).cwiseAbs().cwiseQuotient(torque_limit_nm_).sum();
  };
  double mine = 0.0, old = 0.0;
  Eigen::Vector2d before = problem.torque_before_nm, old_before = problem.torque_before_nm;
  for (std::size_t k = 0; k < targets_.stages(); ++k) {
    mine = std::max(mine, change(before, track_.torque_nm[k]));
    before = track_.torque_nm[k];
    if (previous == nullptr) continue;
    const auto entry = previous->At(problem.first_tick + static_cast<std::int64_t>(k));
    if (!entry) continue;
    old = std::max(old, change(old_before, entry->motion.Torque_nm()));
    old_before = entry->motion.Torque_nm();
  }
  return mine <= std::max(config_.roughness, old);
}

}  // namespace flexarm
