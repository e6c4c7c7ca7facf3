#pragma once

#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "controller/exchange/spsc_queue.h"
#include "controller/realtime/task.h"
#include "controller/realtime/timing_record.h"

namespace flexarm {

/// How a task did so far. Lateness is how long after its due instant it woke, or, if it was still
/// running then, how long after it finished it ran again.
struct TaskStatistics {
  const char* name;
  std::uint64_t activations;
  std::uint64_t missed_deadlines;  ///< finished after the deadline
  std::uint64_t skipped_periods;   ///< not run at all
  std::int64_t worst_lateness_ns;
  double mean_lateness_ns;
  std::int64_t worst_run_ns;  ///< longest stay in Run
};

/// Gives each task a thread that runs it on an absolute grid of CLOCK_MONOTONIC: epoch + phase + n
/// period. A task that is behind skips whole periods, which are counted; the grid stays.
///
/// A task of priority 1..98 gets SCHED_FIFO, the smallest timer slack, a pre-faulted stack and
/// flushed denormals; one of priority 0 is an ordinary thread. The memory of the process is the
/// business of PrepareRealtime (realtime_setup.h).
class RealtimeExecutor {
 public:
  /// @param fifo  false: every thread is ordinary, whatever its priority (--without-realtime)
  explicit RealtimeExecutor(bool fifo);
  ~RealtimeExecutor();  ///< stops and joins
  RealtimeExecutor(const RealtimeExecutor&) = delete;
  RealtimeExecutor& operator=(const RealtimeExecutor&) = delete;

  /// Before Start. `task` and `timing` outlive the executor. Each activation leaves a record in
  /// `timing`, if there is one, with its number on the grid; the task's thread is its producer.
  /// @throws std::invalid_argument for a period, phase or priority out of range
  void Add(Task& task, SpscQueue<TimingRecord>* timing = nullptr);

  /// Starts all threads; instant 0 of the loop is `epoch_ns` of CLOCK_MONOTONIC, best some 10 ms
  /// ahead. Activations due at `end_ns` (in the clock of the loop) or later do not run. Once only.
  /// @throws std::runtime_error  naming task, cause and remedy, with no thread left, if a thread or
  ///   its priority is refused. Never ordinary scheduling instead.
  void Start(std::int64_t epoch_ns, std::int64_t end_ns = INT64_MAX);

  /// Each thread ends after its present or next activation instant, without running it. Any thread.
  void RequestStop() noexcept;

  /// Waits for all threads to end.
  void Join();

  std::size_t size() const noexcept { return threads_.size(); }

  /// Of the task added as number `index`. Any thread, at any time.
  TaskStatistics statistics(std::size_t index) const noexcept;

 private:
  // Written by the task's thread alone, read by any.
  struct alignas(64) Counters {
    std::atomic<std::uint64_t> activations{0};
    std::atomic<std::uint64_t> missed_deadlines{0};
    std::atomic<std::uint64_t> skipped_periods{0};
    std::atomic<std::int64_t> worst_lateness_ns{0};
    std::atomic<std::int64_t> total_lateness_ns{0};
    std::atomic<std::int64_t> worst_run_ns{0};
  };

  struct Thread {
    RealtimeExecutor* executor;
    Task* task;
    Task::Traits traits;
    SpscQueue<TimingRecord>* timing;
    pthread_t handle{};
    bool started = false;
    Counters counters;
  };

  void StartThread(Thread& thread);
  void Loop(Thread& thread) noexcept;
  static void* Main(void* argument) noexcept;

  bool fifo_;
  std::vector<std::unique_ptr<Thread>> threads_;
  std::int64_t epoch_ns_ = 0;
  std::int64_t end_ns_ = INT64_MAX;
  std::atomic<bool> stop_{false};
};

}  // namespace flexarm
