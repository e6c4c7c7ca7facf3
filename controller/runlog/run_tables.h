#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "controller/runlog/record_blocks.h"
#include "controller/runlog/record_format.h"
#include "controller/runlog/sample_table.h"
#include "controller/runlog/sqlite_db.h"

namespace flexarm {

/// Makes the tables of a run in an empty database, and fills them.
///
/// Everything is one transaction, from construction to Commit.
/// Every method throws SqliteError. Thread: one at a time. Not real-time safe.
class RunTables {
 public:
  /// @param db  empty; outlives the tables
  RunTables(SqliteDb* db, Packing packing);

  /// The key start_ns must come before the records with times, and an end last: it becomes the key
  /// result.
  void Add(const RunRecord& record);
  /// Adds what waits for a block to be full. Nothing may follow but Seal and Commit.
  void Finish();
  /// Adds the digest of everything. Nothing may follow but Commit.
  void Seal();
  void Commit();

 private:
  void AddOne(const InfoRecord& record);
  void AddOne(const TicksRecord& record);
  void AddOne(const TimingsRecord& record);
  void AddOne(const SafetyRecord& record);
  void AddOne(const RunEvent& event);
  void AddOne(const EndRecord& record);
  void AddBlock();
  void AddTimings();
  double SinceStart(std::int64_t time_ns) const;

  SqliteDb* db_;
  Packing packing_;
  std::int64_t start_ns_ = 0;
  std::vector<TickRecord> ticks_;  // of the next block
  std::vector<TimingRecord> timings_;
  std::optional<SampleTable> samples_;
  SqliteStatement set_key_, insert_block_, insert_safety_, insert_event_;
};

}  // namespace flexarm
