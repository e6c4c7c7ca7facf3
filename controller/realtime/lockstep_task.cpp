#include "controller/realtime/lockstep_task.h"

#include <algorithm>

namespace flexarm {

LockstepTask::LockstepTask(const std::vector<Task*>& tasks) {
  for (Task* task : tasks) executor_.Add(tasks_.emplace_back(task, &now_ns_));
}

Task::Traits LockstepTask::traits() const noexcept {
  return {.name = "loop",
          .period_ns = kPeriodNs,
          .phase_ns = 0,
          .deadline_ns = kPeriodNs,
          .priority = 0};
}

void LockstepTask::Run(const Activation& activation) noexcept {
  now_ns_ = activation.due_ns + activation.late_ns;
  executor_.RunUntil(activation.due_ns + 1);
}

void LockstepTask::Ended() noexcept {
  for (Late& task : tasks_) task.Ended();
}

void LockstepTask::Late::Run(const Activation& activation) noexcept {
  task_->Run({.due_ns = activation.due_ns,
              .missed_in_a_row = activation.missed_in_a_row,
              .late_ns = std::max<std::int64_t>(*now_ns_ - activation.due_ns, 0),
              .previous_run_ns = activation.previous_run_ns});
}

}  // namespace flexarm
