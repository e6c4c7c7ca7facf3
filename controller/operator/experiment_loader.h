#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "controller/operator/override.h"
#include "controller/operator/request_tracker.h"
#include "controller/runlog/event_queue.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// Plans experiments, asks for their runs, and keeps each until the loop no longer uses it.
///
/// Not real-time safe: planning takes milliseconds to seconds, and allocates. Thread: operator,
/// but for Plan.
class ExperimentLoader {
 public:
  /// A planned experiment for which a run is asked.
  struct Order {
    std::shared_ptr<const PlannedExperiment> planned;
    std::string name;
    std::string text;  ///< for the log: the experiment's file, or the command that it comes from
    LineLevels may_open = 0;                   ///< RunOrder::may_open
    RunLabel label = {};                       ///< for the log
    std::optional<UnmetCondition> unmet = {};  ///< what speaks against the run
  };

  /// All pointers outlive the loader.
  /// @param events  to the recorder: one "experiment" for every run that is asked for
  ExperimentLoader(LoopStack* stack, RequestTracker* requests, EventQueue* events,
                   const Design* design, const LoopGrid& grid, const MotionLimits& limits,
                   const MotionLimits& reduced_limits)
      : stack_(stack),
        requests_(requests),
        events_(events),
        design_(design),
        grid_(grid),
        limits_(limits),
        reduced_limits_(reduced_limits) {}

  /// Plans `experiment` from these hub angles, rad. Any thread.
  /// @throws RejectedError if it is impossible, has simulated events and the rig is real, or a stop
  ///         is requested meanwhile
  Order Plan(const Experiment& experiment, const std::array<double, 2>& start_rad,
             const std::stop_token& stop = {}) const;

  /// Another path for a run, computed by motion_change.h.
  using NewPath = std::function<ReferenceTable(const ReferenceTable& table, int from,
                                               const Design& design, const MotionLimits& limits)>;

  /// The run of `planned` with another path from sample `from` on. Any thread.
  /// @throws RejectedError as NewPath
  Order PlanChange(const PlannedExperiment& planned, int from, const NewPath& path) const;

  /// The experiment of a run or change that was asked for; nullptr: the loop no longer uses it, or
  /// others asked for it.
  std::shared_ptr<const PlannedExperiment> Find(std::uint32_t number) const;

  /// A change of a path, as it is asked for.
  struct Change {
    std::uint32_t run;          ///< number of the run that is changed
    std::int64_t not_after_ns;  ///< last instant at which it may be granted
  };
  /// Asks the safety task for a change; `client` waits for the answer.
  /// @returns the number of the request; 0: the tracker is busy
  std::uint32_t AskForChange(std::int64_t now_ns, int client, Order order, const Change& change);

  /// AskForRun would be refused: another request is not answered yet.
  bool busy() const { return requests_->busy(); }

  /// Asks the safety task for a run of it, and announces it; `client` waits for the answer.
  /// @returns the number of the request and of its run; 0: the tracker is busy
  std::uint32_t AskForRun(std::int64_t now_ns, int client, Order order);

  /// Every answer of the safety task: names the granted experiment, forgets a refused one.
  void Answered(const RequestAnswer& answer);

  /// Announces an experiment to the log.
  /// @param number  of the request for its run; 0: of the next request, made by others
  void Announce(std::int64_t now_ns, const Order& order, std::uint32_t number = 0);

  /// Frees the experiments that the loop no longer uses. Once a period.
  void FreeReleased();

  /// Name of the experiment that was granted last; empty: none.
  const std::string& name() const { return name_; }
  /// How many experiments are in memory.
  std::size_t size() const { return asked_.size(); }

 private:
  struct Asked {
    std::uint32_t number;
    Order order;
  };

  LoopStack* stack_;
  RequestTracker* requests_;
  EventQueue* events_;
  const Design* design_;
  LoopGrid grid_;
  const MotionLimits& limits() const { return stack_->reduced() ? reduced_limits_ : limits_; }

  MotionLimits limits_, reduced_limits_;
  std::deque<Asked> asked_;  // in order of number
  std::string name_;
};

}  // namespace flexarm
