#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "controller/operator/commissioning_commands.h"
#include "controller/operator/experiment_loader.h"
#include "controller/operator/experiment_planner.h"
#include "controller/operator/operator_snapshot.h"
#include "controller/runlog/event_queue.h"

namespace flexarm {

/// The speed of a command, as a share of the planned one; 1 without the key "speed_percent".
/// @throws RejectedError if it is no number from 100 kLeastSpeed to 100
double SpeedOf(const nlohmann::json& command);

/// The commands that change the path of a run while it goes on, of a law that follows one: `pause`,
/// `resume`, `speed` and `retarget`.
///
/// The new path is computed and checked against every limit on a thread of its own, and begins at a
/// sample ahead of the loop; then the safety task is asked for it. A command waits until the loop
/// follows the change before it; a plan that takes too long is made again for a later sample. A
/// stop, a disarm, the end of the run or of the daemon, and a client that has gone cancel it. Not
/// real-time safe. Thread: operator.
class ChangeCommand {
 public:
  /// All of it outlives the command.
  struct Targets {
    ExperimentLoader* experiments;
    EventQueue* events;
    double period_s;
    std::chrono::milliseconds plan_wait{0};  ///< as RunCommand's
  };

  explicit ChangeCommand(Targets targets) : targets_(targets) {}

  static bool Knows(const std::string& name);

  /// Begins a command of `client`; none is being planned.
  /// @returns its refusal; null: the answer comes from Follow, or from the safety task
  /// @throws RejectedError for keys that are malformed
  nlohmann::json Start(const std::string& name, const nlohmann::json& command, int client,
                       const OperatorSnapshot& now);

  /// As RunCommand's.
  std::optional<ClientAnswer> Follow(const OperatorSnapshot& now,
                                     const std::function<bool(int client)>& is_there);

  /// Every answer of the safety task.
  /// @returns of a change: the name of its command
  std::optional<std::string> Answered(std::int64_t now_ns, const RequestAnswer& answer);

  void Cancel() { cancelled_ = waits_.has_value(); }

  bool planning() const { return waits_.has_value(); }

 private:
  /// What a client asks for.
  struct Wish {
    std::string name;
    double speed = 1.0;         ///< of `speed`
    Move goal{.start_s = 0.0};  ///< of `retarget`
  };
  struct Waiting {
    Wish wish;
    int client;
    std::uint32_t run;                                   ///< number of the run
    int ahead;                                           ///< samples from the command to the change
    std::shared_ptr<const PlannedExperiment> planned{};  ///< null: the loop does not follow it yet
    ExperimentLoader::NewPath path{};
    std::string text{};  ///< for the log
    int tries = 1;
    std::int64_t not_after_ns = INT64_MAX;
  };

  static Wish WishOf(const std::string& name, const nlohmann::json& command);
  bool IsFollowed(const OperatorSnapshot& now) const;
  /// @returns why it is refused; null: it is being planned
  nlohmann::json Begin(const OperatorSnapshot& now);
  void BeginPlan(const OperatorSnapshot& now);
  nlohmann::json Decide(ExperimentPlanner::Outcome planned, const OperatorSnapshot& now);
  nlohmann::json Refused(const std::string& refusal, const std::string& error,
                         const std::string& remedy, const OperatorSnapshot& now) const;

  Targets targets_;
  std::optional<Waiting> waits_;
  bool cancelled_ = false;
  std::string asked_name_, asked_text_;     // of the change that is not answered yet
  std::uint32_t asked_ = 0, asked_in_ = 0;  // its number, and that of its run
  std::uint32_t granted_ = 0;               // number of the last change that was granted
  std::uint32_t granted_in_ = 0;            // the run that it changes
  double resume_speed_ = 1.0;
  ExperimentPlanner planner_;
};

}  // namespace flexarm
