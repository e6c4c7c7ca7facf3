#pragma once

#include <atomic>
#include <cstdint>

namespace flexarm {

/// Ends the sleep of a task before its time. A wake that comes while the task runs ends its next
/// sleep at once; several before that are one.
///
/// One sleeper; any thread wakes it, and never waits: one system call (futex). Real-time: safe.
class Wakeup {
 public:
  void Wake() noexcept;

  /// Whether a wake has come since it was last taken; takes it.
  bool Take() noexcept { return set_.exchange(0, std::memory_order_acq_rel) != 0; }

  /// Sleeps until `instant_ns` of CLOCK_MONOTONIC.
  /// @returns true if a wake ended the sleep before, or had come already; takes it
  bool SleepUntil(std::int64_t instant_ns) noexcept;

 private:
  std::atomic<std::uint32_t> set_{0};
};

}  // namespace flexarm
