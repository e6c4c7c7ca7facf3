#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/errors.h"
#include "controller/runlog/run_sink.h"
#include "controller/runlog/sqlite_db.h"

namespace flexarm {

/// Where a run log stands.
enum class RunState {
  kClosed,   ///< SQLite, closed in order or recovered
  kWritten,  ///< a record file that is being written
  kLeft,     ///< a record file whose program was killed, or a copy of one
};

/// Reads one run log, from wherever its file is: a closed run, one that is being written, or what a
/// killed program left. A record file is converted in memory.
///
/// Believes nothing: the schema is compared before anything is read, rows must come in order, and
/// all sizes are limited. Never writes. Every method throws InputError if the file is not valid.
class RunReader {
 public:
  /// @throws InputError: missing, no run log, of another version, damaged
  explicit RunReader(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  const RunInfo& info() const { return info_; }
  RunState state() const { return state_; }
  bool closed() const { return state_ == RunState::kClosed; }
  /// Of a record file: bytes behind its last whole record, which are left out.
  std::uint64_t left_out_bytes() const { return left_out_bytes_; }

  /// The digest that the closed run was given; "" in a record file, whose records have checksums.
  const std::string& digest() const { return digest_; }
  /// True if all that the log holds is as it was written. Reads everything.
  bool DigestHolds();

  // In the order of time. BLOBs are checked for size and version.
  void ForEachTick(const std::function<void(const TickRecord&)>& visit);
  void ForEachTiming(const std::function<void(const TimingRecord&)>& visit);
  void ForEachSafety(const std::function<void(const SafetyRecord&)>& visit);
  void ForEachEvent(const std::function<void(const RunEvent&)>& visit);

  RunContents ReadAll();

 private:
  template <typename Action>
  void Guarded(Action action);
  void OpenRecords(int fd);
  void OpenSqlite(std::int64_t file_bytes);
  void ReadInfo();
  [[noreturn]] void Fail(const std::string& what) const;

  std::filesystem::path file_;
  SqliteDb db_;
  RunInfo info_;
  RunState state_ = RunState::kClosed;
  std::uint64_t left_out_bytes_ = 0;
  std::string digest_;
};

}  // namespace flexarm
