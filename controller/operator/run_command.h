#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "controller/operator/commissioning_commands.h"
#include "controller/operator/experiment_loader.h"
#include "controller/operator/experiment_planner.h"
#include "controller/operator/operator_snapshot.h"
#include "controller/operator/override.h"
#include "controller/operator/override_record.h"
#include "controller/operator/prove_switches.h"
#include "controller/runlog/run_files.h"

namespace flexarm {

/// Name of the condition of `run` by which an experiment is for this law and these payloads.
inline constexpr const char* kExperimentCondition = "experiment";

/// Judges an experiment from these hub angles, rad, before it is planned; nothing: nothing speaks
/// against it. Throws std::exception if it is impossible, or a stop is requested.
using JudgeExperiment = std::function<std::optional<UnmetCondition>(
    const Experiment& experiment, const std::array<double, 2>& start_rad,
    const std::stop_token& stop)>;

/// The command `run`: reads and plans the experiment on a thread of its own, and asks the safety
/// task for the run.
///
/// The conditions of a run hold before it is planned and are judged again when the plan is there:
/// the state, the angles, the proof of the switches, the file of its log, and that the arm stands
/// where the plan begins. A stop, a disarm, the end of the daemon and a client that has gone cancel
/// a plan. Not real-time safe. Thread: operator.
class RunCommand {
 public:
  /// A hub that was turned by more than this while its run was planned: rad.
  static constexpr double kMoved_rad = 0.01;

  /// All of it outlives the command.
  struct Targets {
    ExperimentLoader* experiments;
    CommissioningCommands* commissioning;
    ProveSwitches* switches;
    OverrideRecord* overrides;
    const RunFiles* files = nullptr;  ///< of the logs; null: runs need none
    /// Throws std::exception with the reasons. Called by another thread.
    std::function<Experiment(const std::string& text, const std::string& name)> parse_experiment;
    JudgeExperiment judge_experiment = {};  ///< the same; empty: nothing is judged
    /// How long a period waits for a plan: 0 but in lock step, where time stands still meanwhile.
    std::chrono::milliseconds plan_wait{0};
  };

  explicit RunCommand(Targets targets) : targets_(std::move(targets)) {}

  /// Begins a command of `client`; none is being planned.
  /// @returns its refusal; null: the answer comes from Follow, or from the safety task
  /// @throws RejectedError for keys that are malformed
  nlohmann::json Start(const nlohmann::json& command, int client, const OperatorSnapshot& now);

  /// Once a period, after the commands.
  /// @param is_there  whether a client is still connected
  /// @returns the answer of a command that was planned and then refused
  std::optional<ClientAnswer> Follow(const OperatorSnapshot& now,
                                     const std::function<bool(int client)>& is_there);

  /// A stop or a disarm came: the command that is being planned is refused by the next Follow.
  void Cancel() { cancelled_ = waits_.has_value(); }

  bool planning() const { return waits_.has_value(); }

 private:
  struct Waiting {
    int client;
    std::vector<Override> overrides;
    std::array<double, 2> start_rad;
    RunLabel label;
  };

  /// The refusal by a condition that does not hold; null: all hold.
  /// @param of_plan  what was found while it was planned
  /// @param used     the overrides without which it would be refused
  nlohmann::json WhyNot(const std::vector<Override>& overrides, const OperatorSnapshot& now,
                        const std::optional<UnmetCondition>& of_plan,
                        std::vector<Override>* used) const;
  /// On the planner's thread. An order without a plan is one that is refused.
  ExperimentLoader::Order Plan(const Experiment& experiment, const std::array<double, 2>& start_rad,
                               const std::vector<Override>& overrides,
                               const std::stop_token& stop) const;
  nlohmann::json Decide(Waiting command, ExperimentPlanner::Outcome planned,
                        const OperatorSnapshot& now);

  Targets targets_;
  std::optional<Waiting> waits_;
  bool cancelled_ = false;
  ExperimentPlanner planner_;
};

}  // namespace flexarm
