#pragma once

#include <atomic>
#include <cstdint>

#include "controller/realtime/task.h"

namespace flexarm {

/// A task that does nothing from a set instant on, as if its thread hung: fault injection for the
/// simulated stack ([[sim_event]] freeze = "control"). Real-time: safe.
class FreezingTask final : public Task {
 public:
  /// @param task  outlives this one
  explicit FreezingTask(Task* task) : task_(task) {}

  Traits traits() const noexcept override { return task_->traits(); }
  void Run(const Activation& activation) noexcept override {
    if (activation.due_ns < frozen_from_ns_.load(std::memory_order_acquire)) {
      task_->Run(activation);
    }
  }

  /// Any thread: activations due at `at_ns` or later do nothing.
  void FreezeFrom(std::int64_t at_ns) noexcept {
    frozen_from_ns_.store(at_ns, std::memory_order_release);
  }

 private:
  Task* task_;
  std::atomic<std::int64_t> frozen_from_ns_{INT64_MAX};
};

}  // namespace flexarm
