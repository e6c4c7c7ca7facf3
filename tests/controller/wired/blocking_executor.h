#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <semaphore>
#include <thread>
#include <vector>

#include "controller/realtime/task.h"
#include "controller/realtime/wakeup.h"

namespace flexarm {

/// Discrete-event executor with tasks that may block: while one waits, the others run. One
/// processor with zero execution time; a late task skips whole periods, as under RealtimeExecutor.
///
/// A task that may block has a thread of its own, but only one thread runs at a time, selected by
/// instant and priority alone: every run is the same.
class BlockingExecutor {
 public:
  struct Statistics {
    std::int64_t activations = 0;
    std::int64_t late = 0;     ///< began after the due instant
    std::int64_t missed = 0;   ///< ended after the deadline
    std::int64_t skipped = 0;  ///< whole periods
  };

  BlockingExecutor() = default;
  ~BlockingExecutor() { Stop(); }
  BlockingExecutor(const BlockingExecutor&) = delete;
  BlockingExecutor& operator=(const BlockingExecutor&) = delete;

  void Add(Task& task, bool may_block = false) {
    const auto behind = std::find_if(slots_.begin(), slots_.end(), [&task](const auto& slot) {
      return slot->traits.priority < task.traits().priority;
    });
    auto& slot = *slots_.insert(behind, std::make_unique<Slot>());
    slot->task = &task;
    slot->traits = task.traits();
    slot->next_ns = slot->traits.phase_ns;
    if (may_block) slot->thread = std::thread([this, s = slot.get()] { Loop(s); });
  }

  /// Ends the threads; waiting tasks continue at once, so all objects that they use must still
  /// exist.
  void Stop() {
    over_ = true;
    for (const auto& slot : slots_) {
      if (!slot->thread.joinable()) continue;
      slot->go.release();
      slot->thread.join();
    }
  }

  std::int64_t now_ns() const { return now_ns_; }

  /// Runs everything that is due before `end_ns`.
  void RunUntil(std::int64_t end_ns) {
    for (;;) {
      WakeSlots();
      Slot* next = Next(end_ns);
      if (next == nullptr) break;
      now_ns_ = std::max(now_ns_, next->next_ns);
      next->blocked ? Resume(next) : Begin(next);
    }
    now_ns_ = std::max(now_ns_, end_ns);
  }

  /// From within a task that may block: continues the task at `instant_ns`.
  void BlockUntil(std::int64_t instant_ns) {
    Slot* slot = running_;
    if (over_ || instant_ns <= now_ns_) return;
    slot->blocked = true;
    slot->next_ns = instant_ns;
    back_.release();
    slot->go.acquire();
    slot->blocked = false;
  }

  /// From now on the task neither runs nor continues, as if its thread hung.
  void Stall(const Task& task) {
    for (const auto& slot : slots_) slot->stalled = slot->stalled || slot->task == &task;
  }

  Statistics statistics(const Task& task) const {
    for (const auto& slot : slots_) {
      if (slot->task == &task) return slot->statistics;
    }
    return {};
  }

 private:
  struct Slot {
    Task* task = nullptr;
    Task::Traits traits{};
    std::int64_t due_ns = 0;   // of the activation under way
    std::int64_t next_ns = 0;  // when it is due again, or continues
    bool blocked = false;      // in the middle of an activation
    bool woken = false;        // between two
    bool stalled = false;
    int missed_in_a_row = 0;
    std::int64_t began_ns = 0;
    std::int64_t previous_run_ns = 0;
    Statistics statistics{};
    std::binary_semaphore go{0};
    std::thread thread;
  };

  // A task is woken at the instant of the task that wakes it, unless it is in an activation.
  void WakeSlots() {
    for (const auto& slot : slots_) {
      Wakeup* wakeup = slot->task->wakeup();
      if (slot->blocked || slot->stalled || wakeup == nullptr || !wakeup->Take()) continue;
      slot->woken = true;
      slot->thread.joinable() ? Continue(slot.get()) : RunTask(slot.get());
      slot->woken = false;
    }
  }

  void Continue(Slot* slot) {
    running_ = slot;
    slot->go.release();
    back_.acquire();  // it has ended, or it waits
  }

  // The task that is due first; of several, the one with the highest priority.
  Slot* Next(std::int64_t end_ns) {
    Slot* next = nullptr;
    for (const auto& slot : slots_) {
      const bool sooner = next == nullptr || slot->next_ns < next->next_ns;
      if (!slot->stalled && slot->next_ns < end_ns && sooner) next = slot.get();
    }
    return next;
  }

  void Begin(Slot* slot) {
    const std::int64_t behind = (now_ns_ - slot->next_ns) / slot->traits.period_ns;
    slot->due_ns = slot->next_ns + behind * slot->traits.period_ns;
    slot->missed_in_a_row += static_cast<int>(behind);
    slot->statistics.skipped += behind;
    slot->statistics.late += now_ns_ > slot->due_ns ? 1 : 0;
    ++slot->statistics.activations;
    slot->began_ns = now_ns_;
    Resume(slot);
  }

  void Resume(Slot* slot) {
    if (slot->thread.joinable()) {
      Continue(slot);
      if (slot->blocked) return;
    } else {
      RunTask(slot);
    }
    const bool missed = now_ns_ > slot->due_ns + slot->traits.deadline_ns;
    slot->statistics.missed += missed ? 1 : 0;
    slot->missed_in_a_row = missed ? slot->missed_in_a_row + 1 : 0;
    slot->previous_run_ns = now_ns_ - slot->began_ns;
    slot->next_ns = slot->due_ns + slot->traits.period_ns;
  }

  void RunTask(Slot* slot) const {
    if (slot->woken) return slot->task->Woken(now_ns_);
    slot->task->Run({.due_ns = slot->due_ns,
                     .missed_in_a_row = slot->missed_in_a_row,
                     .late_ns = slot->began_ns - slot->due_ns,
                     .previous_run_ns = slot->previous_run_ns});
  }

  void Loop(Slot* slot) {
    for (;;) {
      slot->go.acquire();
      if (over_) return;
      RunTask(slot);
      if (over_) return;
      back_.release();
    }
  }

  std::int64_t now_ns_ = 0;
  Slot* running_ = nullptr;
  bool over_ = false;
  std::binary_semaphore back_{0};
  std::vector<std::unique_ptr<Slot>> slots_;  // in order of priority, then of Add
};

}  // namespace flexarm
