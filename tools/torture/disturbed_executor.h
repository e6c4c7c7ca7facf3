#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "controller/realtime/task.h"
#include "tools/torture/fault.h"

namespace flexarm {

/// How the threads of a session are woken.
struct WakeUps {
  std::uint64_t seed = 1;
  std::int64_t start_ns = 0;        ///< the clock at the start: a whole period of every task
  std::int64_t latest_ns = 0;       ///< a real-time task wakes up to so much after its due instant
  std::int64_t latest_slow_ns = 0;  ///< the same of tasks of priority 0
  int order_changes = 0;            ///< how often the order of tasks that wake together changes
};

/// Is told when a real-time task begins and ends an activation: a test may forbid the heap between.
class ActivationGuard {
 public:
  virtual ~ActivationGuard() = default;
  virtual void Enter() noexcept = 0;
  virtual void Leave() noexcept = 0;
};

/// Runs tasks on a simulated clock as RealtimeExecutor does on threads, woken late and in any
/// order.
///
/// Tasks that wake at the same instant run in the order of random ranks, which are drawn again
/// at `order_changes` random instants (probabilistic concurrency testing: Burckhardt et al.,
/// "A Randomized Scheduler with Probabilistic Guarantees of Finding Bugs", 2010). An activation
/// that wakes after later periods have begun skips those, and counts them as missed. A task takes
/// no time. The same seed gives the same run.
class DisturbedExecutor {
 public:
  /// @param faults  those of threads are used; outlive the executor
  /// @param end_ns  no change of order comes later after the start
  DisturbedExecutor(const WakeUps& wake_ups, const std::vector<Fault>& faults, std::int64_t end_ns);

  /// @param place  of its faults; nothing: no fault is its own
  void Add(Task& task, std::optional<FaultPlace> place = std::nullopt);

  /// `guard` outlives the executor; null: none. It sees the tasks that have a priority.
  void Watch(ActivationGuard* guard) noexcept { guard_ = guard; }

  /// Threads that hang go on at `now_ns`, as after a restart of what held them.
  void Release(std::int64_t now_ns);

  /// Runs all that wakes before `end_ns`.
  void RunUntil(std::int64_t end_ns);

 private:
  struct Slot {
    Task* task;
    Task::Traits traits;
    std::optional<FaultPlace> place;
    std::int64_t due_ns;
    std::int64_t wake_ns;
    int missed_in_a_row;
    std::uint64_t rank;
  };

  std::int64_t WakeOf(const Slot& slot);
  void RunSlot(Slot* slot);
  void DrawRanks();
  void TakeWakeups(std::int64_t now_ns);

  WakeUps wake_ups_;
  const std::vector<Fault>* faults_;
  std::mt19937_64 random_;
  std::vector<std::int64_t> changes_;  // instants, the last first
  std::vector<Slot> slots_;
  ActivationGuard* guard_ = nullptr;
};

}  // namespace flexarm
