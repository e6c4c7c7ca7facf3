#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "controller/design/run_design.h"
#include "controller/law/design.h"
#include "controller/operator/unattended_run.h"
#include "controller/realtime/lockstep_executor.h"
#include "controller/runlog/blob.h"
#include "controller/tasks/planned_experiment.h"
#include "controller/tasks/simulated_stack.h"
#include "tests/controller/loop/simulated_runs.h"

namespace flexarm {

/// The stack in lock step with a scripted operator, and all its records.
class StackRun {
 public:
  explicit StackRun(const RigConfig& config, const Experiment& experiment, double payload_kg = 0.1)
      : StackRun(config, config, experiment, payload_kg) {}
  /// @param plant  the simulated rig, if it differs from the rig of the design
  StackRun(const RigConfig& config, const RigConfig& plant, const Experiment& experiment,
           double payload_kg)
      : config_(config),
        design_(DesignFor(config)),
        grid_(config.loop),
        planned_(experiment, design_, grid_.period_s(), {0.0, 0.0}, MotionLimitsOf(config)),
        stack_(config, plant, design_, payload_kg) {
    for (Task* task : stack_.tasks()) executor_.Add(*task);
  }

  /// Lets the tasks run until `until_ns`; `unattended` makes the requests of UnattendedRun.
  void Run(std::int64_t until_ns, bool unattended = true) {
    constexpr std::int64_t kLookNs = 20'000'000;
    while (now_ns_ < until_ns) {
      now_ns_ = std::min(now_ns_ + kLookNs, until_ns);
      executor_.RunUntil(now_ns_);
      Collect();
      if (!unattended) continue;
      const OperatorRequest request = operator_.Update(now_ns_, permit());
      if (request.kind != RequestKind::kNone) stack_.requests().Push(request);
    }
  }

  /// Sends a request, waits 20 ms and returns the refusal in the answer.
  Refusal Ask(RequestKind kind) {
    stack_.requests().Push(
        {.kind = kind, .number = ++asked_, .not_before_ns = 0, .run = {.experiment = &planned_}});
    Run(now_ns_ + 20'000'000, false);
    return answer.back().refusal;
  }

  void Press(Line line, int level) {
    stack_.Press({.line = line, .level = level});
    Run(now_ns_ + 20'000'000, false);
  }

  Permit permit() { return stack_.operator_permits().Read().Newest().value; }
  const RigConfig& config() const { return config_; }
  const Design& design() const { return design_; }
  const LoopGrid& grid() const { return grid_; }
  std::int64_t now_ns() const { return now_ns_; }

  /// Sample 0 of the experiment.
  std::int64_t ExperimentStart() { return grid_.ExperimentStart(permit().running_since_ns); }

  std::vector<TickRecord> tick;
  std::vector<SafetyRecord> safety;
  std::vector<RequestAnswer> answer;

 private:
  void Collect() {
    TruthRecord truth{};
    while (stack_.truth_records()->Pop(&truth)) truth_.push_back(truth.truth);
    TickRecord record{};
    while (stack_.tick_records().Pop(&record)) {
      const auto k = static_cast<std::size_t>(record.input.tick);
      if (k < truth_.size()) record.truth = truth_[k];  // a frozen plant has none
      tick.push_back(record);
    }
    SafetyRecord change{};
    while (stack_.safety_records().Pop(&change)) safety.push_back(change);
    RequestAnswer given{};
    while (stack_.answers().Pop(&given)) answer.push_back(given);
  }

  RigConfig config_;
  Design design_;
  LoopGrid grid_;
  PlannedExperiment planned_;
  SimulatedStack stack_;
  LockstepExecutor executor_;
  UnattendedRun operator_{&planned_};
  std::vector<PlantTruth> truth_;  // by tick
  std::int64_t now_ns_ = 0;
  std::uint32_t asked_ = 1000;  // apart from the unattended run's numbers
};

inline bool SameTicks(const StackRun& a, const StackRun& b) {
  if (a.tick.size() != b.tick.size()) return false;
  for (std::size_t i = 0; i < a.tick.size(); ++i) {
    if (!SameBytes(a.tick[i].input, b.tick[i].input)) return false;
    if (!SameBytes(a.tick[i].output, b.tick[i].output)) return false;
    if (a.tick[i].truth.tip_m != b.tick[i].truth.tip_m) return false;
  }
  return true;
}

}  // namespace flexarm
