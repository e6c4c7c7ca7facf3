#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/step/control_step.h"
#include "tests/bench/scenario.h"
#include "tests/support/step_variants.h"

namespace flexarm {

/// Step with a law and an estimator. A candidate resets it at a sample of a simulated run, takes
/// twelve samples as they were, and disturbs the next six: readings that are missing, out of range,
/// outliers, repeated, skewed or old, any counts, late torques, resets, modes and states.
class StepScenario final : public Scenario {
 public:
  /// @param inputs  of the run; both outlive the scenario
  StepScenario(const StepVariant& variant, const std::vector<StepInput>& inputs,
               InstructionCounter& counter);

  static std::string NameOf(const StepVariant& variant) {
    return std::string("step-") + variant.name;
  }
  std::string name() const override { return name_; }
  std::int64_t Median() override;
  std::int64_t Cost(const Candidate& candidate) override;

 private:
  std::string name_;
  const std::vector<StepInput>* inputs_;
  InstructionCounter* counter_;
  std::unique_ptr<ControlStep> step_;
  std::int64_t period_ns_;
};

}  // namespace flexarm
