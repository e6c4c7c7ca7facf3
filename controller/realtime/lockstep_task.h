#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "controller/realtime/lockstep_executor.h"
#include "controller/realtime/task.h"

namespace flexarm {

/// The tasks of a simulated loop as one task, in lock step behind the clock: each activation runs
/// everything that was due since the one before. However late its thread wakes, no activation of
/// the tasks is skipped and their results are those of LockstepExecutor.
///
/// For a loop that moves no metal, on a computer without real time. Each activation gets how late
/// it is (Activation::late_ns). Not real-time safe: catching up takes as long as it takes.
class LockstepTask final : public Task {
 public:
  static constexpr std::int64_t kPeriodNs = 1'000'000;

  /// @param tasks  outlive this one
  explicit LockstepTask(const std::vector<Task*>& tasks);

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;
  void Ended() noexcept override;

 private:
  // One of the tasks, which is told how late it is.
  class Late final : public Task {
   public:
    Late(Task* task, const std::int64_t* now_ns) : task_(task), now_ns_(now_ns) {}
    Traits traits() const noexcept override { return task_->traits(); }
    void Run(const Activation& activation) noexcept override;
    Wakeup* wakeup() noexcept override { return task_->wakeup(); }
    void Woken(std::int64_t now_ns) noexcept override { task_->Woken(now_ns); }
    void Ended() noexcept override { task_->Ended(); }

   private:
    Task* task_;
    const std::int64_t* now_ns_;
  };

  std::int64_t now_ns_ = 0;  // when the present activation began
  std::deque<Late> tasks_;
  LockstepExecutor executor_;
};

}  // namespace flexarm
