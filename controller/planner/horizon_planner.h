#pragma once

#include <Eigen/Core>
#include <array>

#include "controller/law/gain_table.h"
#include "controller/planner/backward_pass.h"
#include "controller/planner/plan_cost.h"
#include "controller/types/horizon_plan.h"
#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// Settings of HorizonPlanner. The design study's values: docs/theory/payload.md 5.
struct HorizonPlannerConfig {
  PlanWeights weights;
  std::array<double, 2> torque_limit_nm;  ///< limits of a plan, +-
  /// Largest change of torque from sample to sample, as a share of the limits, both joints added,
  /// that any plan may have; a rougher plan must be smoother than the plan that it replaces.
  double roughness;
  double payload_change_kg;     ///< with a larger change a plan is no warm start
  double payload_change_share;  ///< or this share of the plan's payload, if larger
};

/// Receding-horizon planner: computes the rest of a move so that the tip is at rest at its end.
///
/// Iterative LQR. Warm start: the previous plan, rolled out from the present state under its gains.
/// Cold start: the quasi-static motion under the gains of a table. Then a backward pass and a line
/// search: rollouts with a share 1, 0.4, 0.1 of its step until one reduces the cost; if none does,
/// the start is kept. Two iterations after a cold start, one after a warm one. Rollouts take 4
/// steps a sample, as in the design study; the backward pass linearises with
/// RigidJointStepper::kSteps.
/// Source: docs/theory/payload.md 5. Real-time: all but the constructor is safe, every loop has a
/// bound; a cold plan of 109 stages takes some milliseconds, so the planner has its own task. Half
/// a megabyte.
class HorizonPlanner {
 public:
  /// Figures of the last plan.
  struct Figures {
    bool warm;                ///< started from the previous plan
    double start_cost, cost;  ///< of the start and of the result, see PlanCost
  };

  /// @param start_gains  for cold starts; the design study's have alpha = 1.5
  HorizonPlanner(const RigidJointArm& arm, double period_s, GainTable start_gains,
                 const HorizonPlannerConfig& config);

  /// @param previous  a plan of the same move, or nullptr for a cold start
  /// @param out       not `previous`; its gains are those of the last backward pass
  /// @returns  false without a stage, if the motion diverges, or if the plan is rougher than
  ///           allowed; then *out is unchanged
  [[nodiscard]] bool Plan(const PlanProblem& problem, const HorizonPlan* previous,
                          HorizonPlan* out) noexcept;

  const Figures& figures() const noexcept { return figures_; }

  /// Whether the plan's payload is close to `payload_kg`. Gains of a heavy payload make a light
  /// model unstable, so a plan for another payload is no warm start for the next.
  bool IsFor(const HorizonPlan& plan, double payload_kg) const noexcept;

 private:
  bool MayContinue(const HorizonPlan& previous, const PlanProblem& problem) const noexcept;
  void RollOutStart(const PlanProblem& problem, const HorizonPlan* previous) noexcept;
  bool Improve(double payload_kg) noexcept;
  bool IsSmooth(const PlanProblem& problem, const HorizonPlan* previous) const noexcept;

  RigidJointStepper linear_, rolling_;
  GainTable start_gains_;
  HorizonPlannerConfig config_;
  Eigen::Vector2d torque_limit_nm_;
  Figures figures_{};
  PlanCost targets_;
  PlanPolicy policy_;
  PlanTrajectory track_, trial_;
};

}  // namespace flexarm
