#pragma once

#include <memory>

#include "tests/bench/scenario.h"
#include "tests/support/study_planner.h"

namespace flexarm {

/// The planner, per stage of the horizon: a plan's cost grows with its length, which the experiment
/// chooses. A candidate is a move of any length and payload, planned from any of its samples and a
/// disturbed state, with a previous plan for another payload, for another state, or without one.
class PlanScenario final : public Scenario {
 public:
  explicit PlanScenario(InstructionCounter& counter);

  std::string name() const override { return "plan-stage"; }
  /// Over the plans of the move of docs/theory/payload.md 5.5, one each ten samples.
  std::int64_t Median() override;
  std::int64_t Cost(const Candidate& candidate) override;

 private:
  std::int64_t PerStage(const PlanProblem& problem, const HorizonPlan* previous);

  InstructionCounter* counter_;
  std::unique_ptr<HorizonPlanner> planner_;
  std::unique_ptr<HorizonPlan> plan_, previous_;
};

}  // namespace flexarm
