#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/append_file.h"
#include "controller/runlog/errors.h"
#include "controller/runlog/record_format.h"
#include "controller/runlog/reserved_run_file.h"
#include "controller/runlog/run_sink.h"

namespace flexarm {

/// A run whose records are complete, before it is a SQLite file. Its file stays locked.
class EndedRun {
 public:
  explicit EndedRun(AppendFile file) : file_(std::move(file)) {}

  /// Writes what the disk has not taken yet, syncs, and turns the record file into SQLite. May be
  /// repeated until it succeeds, on any thread; takes seconds for a long run.
  /// @returns what is wrong, with the file's name; "" once the run is a SQLite file
  std::string Finish() noexcept;

  const std::filesystem::path& path() const { return file_.path(); }

 private:
  AppendFile file_;
};

/// Writes one run: a record file (record_format.h) while it is open, SQLite once it is closed.
///
/// A commit is one write; what it wrote survives the process. A power failure can lose the last
/// seconds before it, for nothing is synced before the end. A disk that fails stops nothing:
/// Trouble() says so, up to kLargestBacklog bytes wait in memory for the next commit, and what
/// comes beyond them is counted and told by an event "gap".
/// Thread: one at a time. Not real-time safe: it allocates and waits for the disk.
class RunWriter : public RunSink {
 public:
  static constexpr std::size_t kLargestBacklog = 64 << 20;  ///< bytes; half an hour at 50 Hz

  /// Creates `file`, and its folder if necessary.
  /// @throws RunLogError if it exists already, or cannot be written
  RunWriter(const std::filesystem::path& file, const RunInfo& info);
  /// Takes a reserved file, which has its final name.
  /// @throws RunLogError if it cannot be written
  RunWriter(ReservedRunFile file, const RunInfo& info);
  /// Closes without a result if neither Close nor End was called; an error is then not reported.
  ~RunWriter() override;

  void Tick(const TickRecord& record) override;
  void Timing(const TimingRecord& record) override;
  void Safety(const SafetyRecord& record) override { Add(record); }
  void Event(const RunEvent& event) override { Add(event); }
  void Commit() override;
  std::string Trouble() const override;

  /// Ends the run without waiting for the disk: EndedRun::Finish does, on another thread if need
  /// be. Nothing may follow.
  EndedRun End(const std::string& result_json);
  /// End and Finish. @throws RunLogError if that fails: the file then holds what the disk took, and
  /// `flexarm log recover` makes a run of it
  void Close(const std::string& result_json) override;

  std::string Name() const override { return name_; }

 private:
  /// @param parts  records of the log that it holds
  void Add(const RunRecord& record, std::size_t parts = 1);
  void AddBlocks();
  void AddGap();

  std::unique_ptr<AppendFile> file_;  // null: ended
  std::string name_;
  TicksRecord ticks_;  // since the last commit, as a rule
  TimingsRecord timings_;
  std::int64_t last_tick_ns_ = 0;
  std::uint64_t lost_records_ = 0;
};

/// "2026-11-20T13:45:06Z" of now.
std::string UtcNow();

/// "<directory>/20261120T134506Z-<name>.flexarm", with "-2", "-3", .. before the suffix if that
/// exists. An empty name becomes "manual"; characters unfit for a file name become "_".
std::filesystem::path NewRunFile(const std::filesystem::path& directory, const std::string& name);

}  // namespace flexarm
