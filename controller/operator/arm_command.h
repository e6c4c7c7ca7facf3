#pragma once

#include <cstdint>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "controller/operator/arm_verdict.h"
#include "controller/operator/commissioning_commands.h"
#include "controller/operator/journal_report.h"
#include "controller/operator/operator_snapshot.h"
#include "controller/operator/override_record.h"
#include "controller/operator/request_tracker.h"
#include "controller/runlog/run_files.h"

namespace flexarm {

/// The command `arm`: judges machine, design and log, and asks the safety task only if they allow
/// it.
///
/// On a wired rig the machine is checked at the start and again for each command, on a thread of
/// its own; on the simulated arm it is not. The file of the next run's log is reserved by the
/// recorder's thread. So the answer comes some periods later. A stop or a disarm cancels a command
/// that waits.
/// Not real-time safe. Thread: operator.
class ArmCommand {
 public:
  /// A check that takes longer leaves the machine unknown, and a file that takes longer is none.
  /// Less than a client waits.
  static constexpr std::int64_t kLongestCheckNs = 3'000'000'000;

  /// All of it outlives the command.
  struct Targets {
    RequestTracker* requests;
    OverrideRecord* overrides;
    RunFiles* files = nullptr;  ///< of the logs; null: runs need none
    JournalReport report;
  };

  ArmCommand(ArmChecks checks, Targets targets);

  /// Begins a command of `client`.
  /// @returns its answer; null: that comes from Follow, or from the safety task
  /// @throws RejectedError for overrides that are malformed
  nlohmann::json Start(const nlohmann::json& command, int client, const OperatorSnapshot& now);

  /// Once a period.
  /// @returns the answer of a command that waited for its check and was refused
  std::optional<ClientAnswer> Follow(const OperatorSnapshot& now);

  /// A stop or a disarm came: the command that waits is refused by the next Follow.
  void Cancel() { cancelled_ = waits_.has_value(); }

  /// A command waits for its check or its file.
  bool waits() const { return waits_.has_value(); }

  /// Why the design alone forbids an arm request, with the remedy; "" if it does not. For a run
  /// without a person.
  std::string WhyNotUnattended() const;

  /// For the status: null on the simulated arm.
  nlohmann::json HostStatus() const;
  nlohmann::json DesignStatus() const { return DesignJson(checks_.design); }

 private:
  struct Waiting {
    int client;
    std::vector<Override> overrides;
    std::int64_t since_ns;
  };

  void BeginCheck();
  void TakeCheck();
  bool AwaitsFile() const;
  void ReportHost();
  /// Null: the safety task was asked.
  nlohmann::json Decide(const Waiting& command, const OperatorSnapshot& now);

  ArmChecks checks_;
  Targets targets_;
  ArmVerdict host_;
  std::vector<Finding> reported_;
  bool has_reported_ = false;
  std::future<ArmVerdict> check_;  // valid while a check runs
  std::optional<Waiting> waits_;
  bool cancelled_ = false;
};

}  // namespace flexarm
