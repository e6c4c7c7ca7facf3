#pragma once

#include <cstdint>

#include "controller/runlog/record_format.h"
#include "controller/runlog/sqlite_db.h"

namespace flexarm {

/// Makes the tables of a run in an empty database, and fills them.
///
/// Everything is one transaction, from construction to Commit.
/// Every method throws SqliteError. Thread: one at a time. Not real-time safe.
class RunTables {
 public:
  /// @param db  empty; outlives the tables
  explicit RunTables(SqliteDb* db);

  /// The key start_ns must come before the records with times, and an end last: it becomes the key
  /// result.
  void Add(const RunRecord& record);
  /// Adds the digest of everything. Nothing may follow but Commit.
  void Seal();
  void Commit();

 private:
  void AddOne(const InfoRecord& record);
  void AddOne(const TickRecord& record);
  void AddOne(const TimingRecord& record);
  void AddOne(const SafetyRecord& record);
  void AddOne(const RunEvent& event);
  void AddOne(const EndRecord& record);
  double SinceStart(std::int64_t time_ns) const;

  SqliteDb* db_;
  std::int64_t start_ns_ = 0;
  SqliteStatement set_key_, insert_tick_, insert_timing_, insert_safety_, insert_event_;
};

}  // namespace flexarm
