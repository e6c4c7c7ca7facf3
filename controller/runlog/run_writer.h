#pragma once

#include <filesystem>
#include <string>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/errors.h"
#include "controller/runlog/run_sink.h"
#include "controller/runlog/sqlite_db.h"

namespace flexarm {

/// Writes one run into one SQLite file.
///
/// While open the file is in WAL mode: readers never wait, and a crash of the process loses only
/// uncommitted rows. Close() leaves one file and no auxiliary files.
/// Thread: one at a time. Not real-time safe: it allocates and waits for the disk.
class RunWriter : public RunSink {
 public:
  /// Creates `file`, its folder if necessary, and its tables.
  /// @throws RunLogError if it exists already, or cannot be written
  RunWriter(std::filesystem::path file, const RunInfo& info);
  /// Closes without a result if Close was not called; an error is then not reported.
  ~RunWriter() override;

  // Each throws RunLogError naming file and cause; rows since the last Commit may then be lost.
  void Tick(const TickRecord& record) override;
  void Timing(const TimingRecord& record) override;
  void Safety(const SafetyRecord& record) override;
  void Event(const RunEvent& event) override;
  void SetExperiment(const std::string& name, const std::string& text) override;
  void Commit() override;
  void Close(const std::string& result_json) override;

  std::string Name() const override { return file_.string(); }

 private:
  template <typename Action>
  void Guarded(Action action);
  void CreateTables();
  void WriteInfo(const RunInfo& info);
  void PrepareStatements();
  void SetKey(const char* key, const std::string& value);
  void BeginIfNeeded();
  double SinceStart(std::int64_t time_ns) const;

  std::filesystem::path file_;
  std::int64_t start_ns_;
  SqliteDb db_;
  SqliteStatement set_key_, insert_tick_, insert_timing_, insert_safety_, insert_event_;
  bool in_transaction_ = false;
  bool has_experiment_;
};

/// "2026-11-20T13:45:06Z" of now.
std::string UtcNow();

/// "<directory>/20261120T134506Z-<name>.flexarm", with "-2", "-3", .. before the suffix if that
/// exists. An empty name becomes "manual"; characters unfit for a file name become "_".
std::filesystem::path NewRunFile(const std::filesystem::path& directory, const std::string& name);

}  // namespace flexarm
