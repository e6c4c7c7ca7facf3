#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
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
    std::unique_ptr<PlannedExperiment> planned;
    std::string name;
    std::string text;  ///< for the log: the experiment's file, or the command that it comes from
    LineLevels may_open = 0;                   ///< RunOrder::may_open
    RunLabel label = {};                       ///< for the log
    std::optional<UnmetCondition> unmet = {};  ///< what speaks against the run
  };

  /// All pointers outlive the loader.
  /// @param events  to the recorder: one "experiment" for every run that is asked for
  ExperimentLoader(LoopStack* stack, RequestTracker* requests, EventQueue* events,
                   const Design* design, const LoopGrid& grid, const MotionLimits& limits)
      : stack_(stack),
        requests_(requests),
        events_(events),
        design_(design),
        grid_(grid),
        limits_(limits) {}

  /// Plans `experiment` from these hub angles, rad. Any thread.
  /// @throws RejectedError if it is impossible, has simulated events and the rig is real, or a stop
  ///         is requested meanwhile
  Order Plan(const Experiment& experiment, const std::array<double, 2>& start_rad,
             const std::stop_token& stop = {}) const;

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
  MotionLimits limits_;
  std::deque<Asked> asked_;  // in order of number
  std::string name_;
};

}  // namespace flexarm
