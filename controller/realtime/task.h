#pragma once

#include <cstdint>

namespace flexarm {

class Wakeup;

/// Periodic task: the body of a thread, or of a slot of the lock-step executor.
///
/// `Run` gets the instant at which the task was due, never the instant at which it woke: a task
/// without other inputs behaves the same under both executors.
class Task {
 public:
  struct Traits {
    const char* name;
    std::int64_t period_ns;
    std::int64_t phase_ns;     ///< due at phase + n period, n >= 0
    std::int64_t deadline_ns;  ///< relative to the due instant; a later end is a missed deadline
    int priority;              ///< SCHED_FIFO 1..98; 0: ordinary scheduling
  };

  struct Activation {
    std::int64_t due_ns;  ///< on the grid phase + n period, in the clock of the loop
    int missed_in_a_row;  ///< consecutive missed deadlines and skipped periods just before
    // Only to watch the host: what a task computes must not depend on them. 0 in lock step.
    std::int64_t late_ns = 0;          ///< from `due_ns` until now
    std::int64_t previous_run_ns = 0;  ///< duration of the activation before
  };

  virtual ~Task() = default;
  virtual Traits traits() const noexcept = 0;
  virtual void Run(const Activation& activation) noexcept = 0;

  /// What may wake the task between two activations; nullptr: nothing does.
  virtual Wakeup* wakeup() noexcept { return nullptr; }
  /// Between two activations, after `wakeup` was woken. @param now_ns  in the clock of the loop
  virtual void Woken(std::int64_t /*now_ns*/) noexcept {}

  /// On the task's thread after its last activation, when the executor stops; other threads may
  /// hang. Not in lock step.
  virtual void Ended() noexcept {}
};

}  // namespace flexarm
