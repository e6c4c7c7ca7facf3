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
    std::int64_t phase_ns;  ///< due at phase + n period
    int priority;           ///< SCHED_FIFO 1..99; 0: ordinary scheduling
    bool every_period;      ///< true: each due instant is run, late or not; false: late ones are skipped
  };

  virtual ~Task() = default;
  virtual Traits traits() const noexcept = 0;
  virtual void Run(std::int64_t due_ns) noexcept = 0;
};

}  // namespace flexarm
