#include "controller/realtime/lockstep_executor.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "controller/realtime/wakeup.h"

namespace flexarm {

void LockstepExecutor::Add(Task& task) {
  const Task::Traits traits = task.traits();
  if (traits.period_ns < 1 || traits.phase_ns < 0) {
    throw std::invalid_argument(
        std::string(traits.name) +
        ": a task needs a period of at least 1 ns and a phase of 0 or more");
  }
  const auto behind = std::find_if(slots_.begin(), slots_.end(), [&traits](const Slot& slot) {
    return slot.priority < traits.priority;
  });
  slots_.insert(behind, Slot{.task = &task,
                             .due_ns = traits.phase_ns,
                             .period_ns = traits.period_ns,
                             .priority = traits.priority});
  next_ns_ = std::min(next_ns_, traits.phase_ns);
}

void LockstepExecutor::RunUntil(std::int64_t end_ns) noexcept {
  const FlushDenormals flush;
  while (next_ns_ < end_ns) RunInstant();
}

void LockstepExecutor::RunInstant() noexcept {
  const std::int64_t now_ns = next_ns_;
  std::int64_t next_ns = INT64_MAX;
  for (Slot& slot : slots_) {
    Wakeup* wakeup = slot.task->wakeup();
    if (wakeup != nullptr && wakeup->Take()) slot.task->Woken(now_ns);
    if (slot.due_ns == now_ns) {
      slot.task->Run({.due_ns = now_ns, .missed_in_a_row = 0});
      slot.due_ns += slot.period_ns;
    }
    next_ns = std::min(next_ns, slot.due_ns);
  }
  next_ns_ = next_ns;
}

}  // namespace flexarm
