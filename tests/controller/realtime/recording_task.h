#pragma once

#include <vector>

#include "controller/realtime/clock.h"
#include "controller/realtime/realtime_executor.h"
#include "tests/support/loop_time.h"

namespace flexarm {

inline constexpr std::int64_t kLeadNs = 20 * kMs;

class RecordingTask : public Task {
 public:
  explicit RecordingTask(Traits traits) : traits_(traits) { activations.reserve(10'000); }
  Traits traits() const noexcept override { return traits_; }
  void Run(const Activation& activation) noexcept override {
    activations.push_back(activation);
    Body(activation);
  }
  virtual void Body(const Activation&) noexcept {}

  std::vector<Activation> activations;  // reserved: read it after Join

 private:
  Traits traits_;
};

inline Task::Traits Every(std::int64_t period_ns, int priority = 0, std::int64_t phase_ns = 0) {
  return {.name = "test",
          .period_ns = period_ns,
          .phase_ns = phase_ns,
          .deadline_ns = period_ns,
          .priority = priority};
}

// Runs until every task was activated `count` times, however long that takes on a loaded machine.
inline void RunFor(RealtimeExecutor& executor, std::int64_t epoch_ns, std::uint64_t count) {
  executor.Start(epoch_ns);
  for (std::size_t i = 0; i < executor.size(); ++i) {
    while (executor.statistics(i).activations < count) SleepUntil(MonotonicNow() + 1 * kMs);
  }
  executor.RequestStop();
  executor.Join();
}

}  // namespace flexarm
