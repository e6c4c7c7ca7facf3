#pragma once

#include <cstdint>
#include <vector>

#include "controller/realtime/float_environment.h"
#include "controller/realtime/task.h"

namespace flexarm {

/// Discrete-event executor: runs all tasks on the calling thread on a simulated clock, as fast as
/// possible. Tasks run in order of due instant, then of priority (highest first), then of Add. A
/// task that one of higher priority wakes is woken at the same instant. No deadline is ever missed.
///
/// Denormals are flushed while tasks run, as under RealtimeExecutor.
/// Thread: one. Does not allocate after the last Add.
class LockstepExecutor {
 public:
  /// `task` outlives the executor. Not from within a run.
  /// @throws std::invalid_argument for a period below 1 ns or a negative phase
  void Add(Task& task);

  /// Runs every activation due before `end_ns`.
  void RunUntil(std::int64_t end_ns) noexcept;

  /// Runs all activations of one due instant after another while `go_on(next_instant_ns)` is true.
  template <typename Predicate>
  void RunWhile(Predicate go_on) {
    const FlushDenormals flush;
    while (next_ns_ != INT64_MAX && go_on(next_ns_)) RunInstant();
  }

  /// Due instant of the next activation; INT64_MAX without tasks.
  std::int64_t next_ns() const noexcept { return next_ns_; }

 private:
  struct Slot {
    Task* task;
    std::int64_t due_ns;
    std::int64_t period_ns;
    int priority;
  };

  void RunInstant() noexcept;

  std::vector<Slot> slots_;  // in order of priority, then of Add
  std::int64_t next_ns_ = INT64_MAX;
};

}  // namespace flexarm
