#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "controller/operator/arm_command.h"
#include "controller/operator/change_command.h"
#include "controller/operator/command_record.h"
#include "controller/operator/commissioning_commands.h"
#include "controller/operator/journal_report.h"
#include "controller/operator/lease.h"
#include "controller/operator/operator_snapshot.h"
#include "controller/operator/prove_switches.h"
#include "controller/operator/request_tracker.h"
#include "controller/operator/run_command.h"
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
    CommissioningCommands* commissioning;
    ProveSwitches* switches;
    ArmCommand* arm;
    RunCommand* run;
    ChangeCommand* change;
    Lease* lease;
    CommandRecord* record;
    const RunFiles* files = nullptr;  ///< of the logs; null: runs need none
    std::function<nlohmann::json()> status;
    JournalReport report;
  };

  explicit CommandDispatch(Targets targets);

  /// Never throws for a bad command: the answer says what is wrong, and has the state. The command
  /// is in the record.
  /// @param by  who gave it
  /// @returns null: the answer comes when the safety task, or the commissioner, has given it
  nlohmann::json Answer(int client, const Peer& by, const std::string& line,
                        const OperatorSnapshot& now);

 private:
  nlohmann::json Dispatch(int client, const Peer& by, const nlohmann::json& command,
                          const OperatorSnapshot& now);
  nlohmann::json SetLine(const nlohmann::json& command);
  nlohmann::json SetLimits(const nlohmann::json& command, const OperatorSnapshot& now);
  /// The job under way besides which no command may add energy; empty: none is.
  std::string JobUnderWay() const;
  /// Passes a command on that the role and the lease permit.
  nlohmann::json Start(const std::string& name, int client, const nlohmann::json& command,
                       const OperatorSnapshot& now);

  Targets targets_;
};

}  // namespace flexarm
