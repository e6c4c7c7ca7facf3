#pragma once

#include <cstdint>

namespace flexarm {

/// One of the daemon's periodic activities: the body of a thread, or of a slot in lock step.
///
/// `Run` gets the instant at which it was due, never the instant at which it woke: a task that
/// depends on nothing else behaves the same under both executors.
class Task {
 public:
  struct Traits {
    const char* name;
    std::int64_t period_ns;
    std::int64_t phase_ns;     ///< due at phase + n period, n >= 0
    std::int64_t deadline_ns;  ///< after the due instant; finishing later is a missed deadline
    int priority;              ///< SCHED_FIFO 1..98; 0: ordinary scheduling
  };

  struct Activation {
    std::int64_t due_ns;  ///< on the grid phase + n period, in the clock of the loop
    int missed_in_a_row;  ///< deadlines missed or periods skipped just before this one
  };

  virtual ~Task() = default;
  virtual Traits traits() const noexcept = 0;
  virtual void Run(const Activation& activation) noexcept = 0;
};

}  // namespace flexarm
