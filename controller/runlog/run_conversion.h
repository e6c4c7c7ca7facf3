#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "controller/runlog/record_file_reader.h"
#include "controller/runlog/sqlite_db.h"

namespace flexarm {

/// What stood in a record file beside its whole records.
struct RecordFileEnd {
  bool ended = false;                       ///< in order, by an EndRecord
  std::uint64_t left_out_bytes = 0;         ///< behind the last whole record
  std::optional<std::uint64_t> damaged_at;  ///< nothing from there on was read
};

/// Makes the tables of a run in an empty database, from all whole records. A run that was not
/// ended has no result. @throws SqliteError
RecordFileEnd FillTables(RecordFileReader* from, SqliteDb* db);

/// Turns a record file into the SQLite file of the same name. At each instant the name means the
/// whole record file or the whole SQLite file, and both have been synced. A run that was not ended
/// gets a result with `recovered` true. A damaged file also stays, as DamagedNameOf(file).
///
/// Two seconds for an hour of a run, about; it needs about as much space as the record file.
/// Not real-time safe. Thread: any, one at a time for a file.
/// @param fd  of `file`, open for reading, locked (run_file_lock.h)
/// @throws RunLogError that names file and cause; the record file then is as it was
RecordFileEnd ConvertRecordFile(int fd, const std::filesystem::path& file);

/// "<file>.damaged"
std::filesystem::path DamagedNameOf(const std::filesystem::path& file);

}  // namespace flexarm
