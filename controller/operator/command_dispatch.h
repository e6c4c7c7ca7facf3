#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "controller/operator/arm_command.h"
#include "controller/operator/commissioning_commands.h"
#include "controller/operator/experiment_loader.h"
#include "controller/operator/journal_report.h"
#include "controller/operator/operator_snapshot.h"
#include "controller/operator/override_record.h"
#include "controller/operator/prove_switches.h"
#include "controller/operator/request_tracker.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// Parses a command line of a client and passes it to the part that carries it out.
///
/// A command is a JSON object: {"command": "arm"}. Every answer has "ok"; a refused one has "error"
/// and, where there is one, "remedy". Not real-time safe. Thread: operator.
class CommandDispatch {
 public:
  /// What the commands act on. All of it outlives the dispatch.
  struct Targets {
    LoopStack* stack;
    RequestTracker* requests;
    ExperimentLoader* experiments;
    CommissioningCommands* commissioning;
    ProveSwitches* switches;
    OverrideRecord* overrides;
    ArmCommand* arm;
    std::function<nlohmann::json()> status;
    /// Throws std::exception with the reasons.
    std::function<Experiment(const std::string& text, const std::string& name)> parse_experiment;
    JournalReport report;
  };

  explicit CommandDispatch(Targets targets);

  /// Never throws for a bad command: the answer says what is wrong.
  /// @returns null: the answer comes when the safety task, or the commissioner, has given it
  nlohmann::json Answer(int client, const std::string& line, const OperatorSnapshot& now);

 private:
  nlohmann::json Dispatch(int client, const std::string& line, const OperatorSnapshot& now);
  nlohmann::json SetLine(const nlohmann::json& command, SafetyState state);
  nlohmann::json StartRun(const nlohmann::json& command, int client, const OperatorSnapshot& now);

  Targets targets_;
};

}  // namespace flexarm
