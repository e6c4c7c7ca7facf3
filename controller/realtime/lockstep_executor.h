#pragma once

#include <cstdint>
#include <vector>

#include "controller/realtime/float_environment.h"
#include "controller/realtime/task.h"

namespace flexarm {

/// Runs tasks on the calling thread on a simulated clock, as fast as they go: whatever is due, in
/// order of instant, then priority (highest first), then order of Add. No deadline is ever missed.
///
/// Denormals are flushed while tasks run, as under RealtimeExecutor.
/// Thread: one. Does not allocate after the last Add.
class LockstepExecutor {
 public:
  /// `task` outlives the executor. Not while running.
  /// @throws std::invalid_argument for a period below 1 ns or a negative phase
  void Add(Task& task);

  /// Runs every activation due before `end_ns`.
  void RunUntil(std::int64_t end_ns) noexcept;

  /// Runs instant by instant as long as `go_on(instant_ns)` says so of the next one.
  template <typename Predicate>
  void RunWhile(Predicate go_on) {
    const FlushDenormals flush;
    while (next_ns_ != INT64_MAX && go_on(next_ns_)) RunInstant();
  }

  /// When the next activation is due; INT64_MAX without tasks.
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
