#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "controller/commissioning/commissioner.h"
#include "controller/operator/experiment_loader.h"
#include "controller/operator/journal_report.h"
#include "controller/operator/operator_snapshot.h"
#include "controller/operator/request_tracker.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// An answer and the client that it is for.
struct ClientAnswer {
  int client;
  nlohmann::json json;
};

/// Connects the commissioner to the loop: gives it every step, loads and starts its motions, hands
/// its calibration to the loop, and returns its answer for the client that made the command.
///
/// Not real-time safe. Thread: operator.
class CommissioningCommands {
 public:
  /// What the commands act on. All of it outlives them.
  struct Targets {
    LoopStack* stack;
    ExperimentLoader* experiments;
    RequestTracker* requests;
    JournalReport report;
  };

  /// Reads the calibration file, if there is one, and hands it to the loop.
  /// @throws InputError if it is not for these sensors
  CommissioningCommands(const RigConfig& config, Targets targets);

  /// Begins a command of `client`. Its answer comes from TakeAnswer or Answered.
  /// @throws RejectedError if it cannot be done now, or makes no sense, or a request is in flight
  void Start(const nlohmann::json& command, int client, const OperatorSnapshot& now);

  /// A command is under way.
  bool busy() const { return commissioner_.busy(); }

  /// Why no experiment may run yet, and what to do; empty: it may.
  std::string WhyNoRun() const { return commissioner_.WhyNoRun(); }
  bool NeedsPluck() const { return commissioner_.NeedsPluck(); }

  /// Once a period, before Take: LoopStack::count_epochs.
  void Follow(const CountEpochs& epochs);

  /// Every step of the loop, in order.
  void Take(const TickRecord& tick);

  /// Which joint angles are known.
  const AngleKnowledge& angles() const { return commissioner_.angles(); }

  /// A command waits so long for the next step of the loop; then it ends with an error.
  static constexpr std::int64_t kLoopStandsNs = 1'000'000'000;

  /// Once a period, after Take. The answer of a command that has ended, once; empty: none has.
  std::optional<ClientAnswer> TakeAnswer(const OperatorSnapshot& now);

  /// Every answer of the safety task.
  /// @returns the answer of the command whose motion the safety task has refused; empty: none
  std::optional<ClientAnswer> Answered(const RequestAnswer& answer, const OperatorSnapshot& now);

 private:
  /// Hands calibration and unknown angles to the loop; reports an angle that became unknown.
  void Publish(std::uint8_t unknown_before);
  ClientAnswer Finish(nlohmann::json answer, const Permit& permit);

  Targets targets_;
  Commissioner commissioner_;
  int client_ = -1;            // of the newest command
  std::string command_;        // its name
  std::int64_t heard_ns_ = 0;  // it began then, or a step of the loop came
  bool stepped_ = false;       // since the last TakeAnswer
  std::uint32_t request_ = 0;  // of its motion; 0: none
};

}  // namespace flexarm
