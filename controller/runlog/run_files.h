#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "controller/runlog/reserved_run_file.h"
#include "controller/runlog/run_finisher.h"
#include "controller/runlog/run_sink.h"
#include "controller/types/runtime_config.h"

namespace flexarm {

/// State of the run logs, for the operator.
struct LogStatus {
  bool required = true;           ///< LogConfig::required
  bool answered = false;          ///< what was asked for last has been tried
  bool ready = false;             ///< and a file is reserved for the next run
  std::string file;               ///< of the run that is being recorded; empty: none is
  std::string error;              ///< why there is no file, or what a run waits for; empty: nothing
  std::optional<double> free_mb;  ///< on the disk of the logs; empty: cannot be asked
};

/// The files of the daemon's runs: reserves the next run's before the arm may be armed, gives it to
/// the recorder when the run begins, and reserves the next; removes one that was not used.
///
/// The recorder's thread alone touches the disk. The operator's says what it wants and reads the
/// status, and never waits for a disk that stands still.
class RunFiles {
 public:
  /// For the journal. Called on the recorder's thread.
  using Report = std::function<void(bool is_error, const std::string& text)>;

  /// @param finisher  outlives this: takes the runs that have ended
  RunFiles(std::filesystem::path directory, const LogConfig& config, RunFinisher* finisher,
           Report report);

  // Operator thread.
  /// Asks for a reserved file until Release. A file that is there already may serve; `ready` is
  /// about this call, or a later one, only.
  void Want();
  /// No run is to come: the reserved file is removed.
  void Release();
  LogStatus status() const;

  // Recorder's thread.
  /// Once a period: does what was asked for. What fails is tried again every second, and at the
  /// next Want.
  void Follow(std::int64_t now_ns) noexcept;
  /// The sink of a run that begins. Without a reserved file it makes one.
  /// @throws RunLogError
  std::unique_ptr<RunSink> Open(const RunInfo& info);

 private:
  class Recorded;

  void Reserve();
  void SetError(const std::string& error);
  void Publish(std::uint32_t asked);

  std::filesystem::path directory_;
  LogConfig config_;
  RunFinisher* finisher_;
  Report report_;

  std::atomic<std::uint32_t> asked_{0};  // number of the newest Want; 0: released
  std::uint32_t last_asked_ = 0;         // operator's

  // Recorder's.
  ReservedRunFile reserved_;
  std::string reserve_error_;
  std::string run_file_;                     // of the open run
  std::string run_trouble_;                  // RunSink::Trouble of the open run
  std::optional<std::uint64_t> free_bytes_;  // as last looked at
  std::int64_t next_try_ns_ = INT64_MIN;
  std::int64_t next_look_ns_ = INT64_MIN;

  mutable std::mutex mutex_;  // held for a copy, never during I/O
  LogStatus status_;
  std::uint32_t answered_ = 0;  // the Want that was tried last
  bool is_reserved_ = false;
};

}  // namespace flexarm
