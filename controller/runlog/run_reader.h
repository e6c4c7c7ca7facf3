#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/errors.h"
#include "controller/runlog/run_sink.h"
#include "controller/runlog/sqlite_db.h"

namespace flexarm {

/// Reads one run log, also while it is being written, after its process was killed (the committed
/// rows are in the -wal file), or from a read-only folder.
///
/// Never writes to the log. Every method throws InputError if the file is not valid.
class RunReader {
 public:
  /// @throws InputError: missing, not SQLite, another application's, a newer schema, damaged
  explicit RunReader(const std::filesystem::path& file);
  ~RunReader();
  RunReader(const RunReader&) = delete;
  RunReader& operator=(const RunReader&) = delete;

  const std::filesystem::path& file() const { return file_; }
  const RunInfo& info() const { return info_; }
  /// False: the run is still open, or its process was killed.
  bool closed() const { return closed_; }

  // In the order of time. BLOBs are checked for size and version.
  void ForEachTick(const std::function<void(const TickRecord&)>& visit);
  void ForEachTiming(const std::function<void(const TimingRecord&)>& visit);
  void ForEachSafety(const std::function<void(const SafetyRecord&)>& visit);
  void ForEachEvent(const std::function<void(const RunEvent&)>& visit);

  RunContents ReadAll();

 private:
  class TemporaryCopy;

  template <typename Action>
  void Guarded(Action action);
  void OpenFile();
  void TryOpen(const std::filesystem::path& file, bool immutable);
  void CheckIdentity();
  void ReadInfo();
  bool HasGateColumn();
  void SetInfo(const std::string& key, const std::string& value);
  [[noreturn]] void Fail(const std::string& what) const;

  std::filesystem::path file_;
  std::unique_ptr<TemporaryCopy> copy_;
  SqliteDb db_;
  RunInfo info_;
  bool closed_ = false;
};

/// True if `file` begins as a SQLite file does; false also if it cannot be read.
bool LooksLikeSqlite(const std::filesystem::path& file);

}  // namespace flexarm
