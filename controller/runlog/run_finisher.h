#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "controller/runlog/run_writer.h"
#include "controller/runlog/trip_reports.h"

namespace flexarm {

/// Makes SQLite files of runs that have ended, on a thread of its own: that takes seconds for a
/// long run, and the recorder must go on. A run that cannot be finished, as on a full disk, is
/// tried again every second; what is still open at the end stays a record file, which the next
/// start of the daemon or `flexarm log recover` finishes.
class RunFinisher {
 public:
  /// For the journal. Called on the finisher's thread.
  using Report = std::function<void(bool is_error, const std::string& text)>;

  /// @param reports  of the trips of these runs, written after them on the same thread; outlives
  ///                 this; null: none
  explicit RunFinisher(Report report, TripReports* reports = nullptr)
      : report_(std::move(report)), reports_(reports) {}
  ~RunFinisher() { Stop(); }
  RunFinisher(const RunFinisher&) = delete;
  RunFinisher& operator=(const RunFinisher&) = delete;

  /// Begins the thread. Once.
  void Start();

  /// Any thread. Does not wait for the disk.
  void Add(EndedRun run);

  /// Waits until each run was finished, or tried once more. Nothing may be added after it. Without
  /// Start, the runs are finished here.
  void Stop();

  /// Runs that were left unfinished; after Stop.
  std::int64_t unfinished() const { return static_cast<std::int64_t>(runs_.size()); }

 private:
  struct Waiting {
    EndedRun run;
    std::string error;  // of the last try
  };

  void Work();
  void TakeAdded();
  /// Tries each run once. @returns true if all are finished, and no report waits for the disk
  bool Try();

  Report report_;
  TripReports* reports_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<EndedRun> added_;
  bool stopping_ = false;
  std::deque<Waiting> runs_;  // of the thread
  std::thread thread_;
};

}  // namespace flexarm
