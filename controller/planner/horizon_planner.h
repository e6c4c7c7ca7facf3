#pragma once

#include <Eigen/Core>
#include <array>

#include "controller/law/gain_table.h"
#include "controller/planner/backward_pass.h"
#include "controller/planner/plan_cost.h"
#include "controller/types/horizon_plan.h"
#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

/// What HorizonPlanner has to be told. The design study's values: docs/theory/payload.md 5.
struct HorizonPlannerConfig {
  PlanWeights weights;
  std::array<double, 2> torque_limit_nm;  ///< a plan keeps within +-these
  /// Largest change of torque from sample to sample, as a share of the limits, both joints added,
  /// that is taken from any plan; a rougher one must be smoother than the plan it replaces.
  double roughness;
  double payload_change_kg;     ///< with a larger change a plan is no start for the next
  double payload_change_share;  ///< or this share of the plan's payload, if that is more
};

/// Plans the rest of a move: the torques with which the tip is at rest when the move ends.
///
/// Iterative LQR. A plan starts from the previous one, rolled out from the present state under its
/// gains, or from the quasi-static motion under the gains of a table. Then a backward sweep and
/// rollouts with a share of its step, 1, 0.4, 0.1, until one costs less; none: the start is kept.
/// Two such rounds after a cold start, one after a warm one. Rollouts take 4 steps a sample, as the
/// design study's do; the sweep linearises with RigidJointStepper::kSteps.
/// Source: docs/theory/payload.md 5. Real-time: all but the constructor is safe, every loop has a
/// bound; a cold plan of 109 stages takes some milliseconds, so it has a task of its own. Half a
/// megabyte.
class HorizonPlanner {
 public:
  /// Of the last plan.
  struct Figures {
    bool warm;                ///< started from the previous plan
    double start_cost, cost;  ///< of the start and of what came out, see PlanCost
  };

  /// @param start_gains  for cold starts; the design study's have alpha = 1.5
  HorizonPlanner(const RigidJointArm& arm, double period_s, GainTable start_gains,
                 const HorizonPlannerConfig& config);

  /// @param previous  a plan of the same move, or nullptr: a move starts
  /// @param out       not `previous`; its gains are those of the last sweep
  /// @returns  false: no stage, a motion that leaves all bounds, or a plan rougher than allowed;
  ///           then *out is as before
  [[nodiscard]] bool Plan(const PlanProblem& problem, const HorizonPlan* previous,
                          HorizonPlan* out) noexcept;

  const Figures& figures() const noexcept { return figures_; }

  /// Whether a plan is made for about this payload. Gains of a heavy payload make a light model
  /// unstable, so a plan for another one is no start for the next.
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
  PlanTrack track_, trial_;
};

}  // namespace flexarm
