#pragma once

#include <vector>

#include "controller/safety/safety_monitor.h"
#include "tests/bench/scenario.h"

namespace flexarm {

/// The safety tick of a rig with two buses. A candidate arms and runs the rig, which takes 40
/// ticks, and disturbs the next six: levels, faults of the loop, buses and drives that fail, silent
/// tasks, lines that are slow or fail, late ticks, requests, stop, disarm and shutdown.
class SafetyScenario final : public Scenario {
 public:
  explicit SafetyScenario(InstructionCounter& counter);

  std::string name() const override { return "safety-tick"; }
  /// Over half a second of an undisturbed run.
  std::int64_t Median() override;
  std::int64_t Cost(const Candidate& candidate) override;

 private:
  MonitorLimits limits_;
  InstructionCounter* counter_;
};

}  // namespace flexarm
