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

/// Timing statistics of a task. Lateness is the time from the due instant to the wake-up; if the
/// task was still running at the due instant, the time from its end to its next start.
struct TaskStatistics {
  const char* name;
  std::uint64_t activations;
  std::uint64_t missed_deadlines;  ///< finished after the deadline
  std::uint64_t skipped_periods;   ///< periods without an activation
  std::int64_t worst_lateness_ns;
  double mean_lateness_ns;
  std::int64_t worst_run_ns;  ///< longest duration of Run
};

/// Periodic-task executor: gives each task a thread that runs it on an absolute grid of
/// CLOCK_MONOTONIC: epoch + phase + n period. A late task skips whole periods, which are counted;
/// the grid does not shift.
///
/// A task of priority 1..98 gets SCHED_FIFO, the smallest timer slack, a pre-faulted stack and
/// flushed denormals; one of priority 0 gets ordinary scheduling. PrepareRealtime
/// (realtime_setup.h) prepares the memory of the process.
class RealtimeExecutor {
 public:
  /// @param fifo  false: ordinary scheduling for every thread (--without-realtime)
  explicit RealtimeExecutor(bool fifo);
  ~RealtimeExecutor();  ///< stops and joins
  RealtimeExecutor(const RealtimeExecutor&) = delete;
  RealtimeExecutor& operator=(const RealtimeExecutor&) = delete;

  /// Before Start. `task` and `timing` outlive the executor. Each activation adds a record to
  /// `timing`, if given, with its number on the grid; the task's thread is the producer.
  /// @throws std::invalid_argument for a period, phase or priority out of range
  void Add(Task& task, SpscQueue<TimingRecord>* timing = nullptr);

  /// Starts all threads; instant 0 of the loop is `epoch_ns` of CLOCK_MONOTONIC, best some 10 ms
  /// ahead. Activations due at `end_ns` (in the clock of the loop) or later do not run. Call once
  /// only.
  /// @throws std::runtime_error  naming task, cause and remedy, with no thread left running, if a
  ///   thread or its priority is refused. Never falls back to ordinary scheduling.
  void Start(std::int64_t epoch_ns, std::int64_t end_ns = INT64_MAX);

  /// Each thread ends after its present activation, or at its next one without running it. Any
  /// thread.
  void RequestStop() noexcept;

  /// Waits for all threads to end.
  void Join();

  std::size_t size() const noexcept { return threads_.size(); }

  /// Statistics of the task that was added as number `index`. Any thread, at any time.
  TaskStatistics statistics(std::size_t index) const noexcept;

 private:
  // Written by the task's thread only, read by any thread.
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
  /// Sleeps until the task is due; a wake before that runs its Woken.
  void AwaitDue(Task& task, std::int64_t due_ns) noexcept;
  static void* Main(void* argument) noexcept;

  bool fifo_;
  std::vector<std::unique_ptr<Thread>> threads_;
  std::int64_t epoch_ns_ = 0;
  std::int64_t end_ns_ = INT64_MAX;
  std::atomic<bool> stop_{false};
};

}  // namespace flexarm
