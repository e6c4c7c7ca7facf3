#pragma once

#include <cstdint>
#include <deque>

#include "controller/exchange/spsc_queue.h"
#include "controller/realtime/task.h"
#include "controller/realtime/timing_record.h"
#include "controller/runlog/event_queue.h"
#include "controller/runlog/run_files.h"
#include "controller/runlog/run_recording.h"

namespace flexarm {

/// Queues that the recorder reads. Everything outlives the task.
struct RecorderChannels {
  SpscQueue<TickRecord>* ticks;
  SpscQueue<SafetyRecord>* safety;
  SpscQueue<TimingRecord>* timing;
  EventQueue* events;
  SpscQueue<TruthRecord>* truth = nullptr;  ///< of a simulated arm; null: there is none
};

/// Recorder task: drains the queues every 50 ms into the log of the run.
///
/// Records of the four queues are merged in order of their instants, delayed by 100 ms so that all
/// records of an instant have arrived. So the set of records in a log depends on the time grid
/// alone, and both executors write the same log. Commits every 0.25 s: a killed process loses at
/// most 0.4 s.
/// Not real-time safe. Thread: its own, or the lock-step executor's.
class RecorderTask final : public Task {
 public:
  static constexpr std::int64_t kPeriodNs = 50'000'000;

  /// @param recording  outlives the task
  /// @param files  of the daemon's runs, followed once a period; null: the runs have other files
  RecorderTask(RecorderChannels channels, RunRecording* recording, RunFiles* files = nullptr);

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  /// Records all remaining data and closes the run. Call when no other task runs any more.
  void Finish() noexcept;

 private:
  void Drain();
  /// Passes all records up to `horizon_ns` to the recording, in order of time.
  void Merge(std::int64_t horizon_ns);
  /// Adds what the simulated arm did at the record's tick.
  void AddTruth(TickRecord* record);
  void NoteDropped(std::int64_t now_ns);

  RecorderChannels channels_;
  RunRecording* recording_;
  RunFiles* files_;
  std::deque<TickRecord> ticks_;
  std::deque<SafetyRecord> safety_;
  std::deque<TimingRecord> timing_;
  std::deque<RunEvent> events_;
  std::deque<TruthRecord> truth_;
  std::uint64_t dropped_ = 0;
  std::int64_t committed_ns_ = INT64_MIN;
};

}  // namespace flexarm
