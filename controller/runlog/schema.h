#pragma once

#include <cstdint>
#include <string>

namespace flexarm {

class SqliteDb;

// The tables of a closed run. One SQLite file is one run.
//
// Table `block` has the records of the control task bit by bit, for replay. The views `tick` and
// `timing` are for users and their tools, in the units of their names: sample_table.h.

inline constexpr std::int64_t kRunLogApplicationId = 0x466c4172;  ///< "FlAr"
inline constexpr std::int64_t kRunLogSchemaVersion = 3;           ///< PRAGMA user_version

/// All but the tables and views of sample_table.h and safety_rows.h.
inline constexpr const char* kRunLogSchema = R"sql(
CREATE TABLE run (
  key TEXT PRIMARY KEY,
  value TEXT NOT NULL
) WITHOUT ROWID;

CREATE TABLE block (
  first_tick INTEGER PRIMARY KEY,
  records BLOB NOT NULL
);

CREATE TABLE event (
  number INTEGER PRIMARY KEY,
  time_ns INTEGER,
  time_s REAL,
  kind TEXT, name TEXT, text TEXT,
  value_json TEXT
);
)sql";

// Keys of table `run`. `result` and `digest` exist once the run was closed.
namespace run_key {
inline constexpr const char* kStartUtc = "start_utc";
inline constexpr const char* kStartNs = "start_ns";  ///< time_s = 0, in the clock of the loop
inline constexpr const char* kVersion = "version";
inline constexpr const char* kBuildId = "build_id";
inline constexpr const char* kRigName = "rig_name";
inline constexpr const char* kClock = "clock";
inline constexpr const char* kBackend = "backend";
inline constexpr const char* kSeed = "seed";
inline constexpr const char* kConfig = "config";
inline constexpr const char* kExperimentName = "experiment_name";
inline constexpr const char* kExperiment = "experiment";
inline constexpr const char* kGains = "gains";
inline constexpr const char* kLaw = "law";
inline constexpr const char* kPayload = "payload_kg";  ///< empty: not known
inline constexpr const char* kLabel = "label";         ///< JSON: name, note, tags
inline constexpr const char* kResult = "result";
inline constexpr const char* kDigest = "digest";  ///< run_digest.h
}  // namespace run_key

/// Makes all tables, and marks the file as a run log of this version. @throws SqliteError
void CreateRunTables(SqliteDb* db);

/// Why a database is no run log of this version: its marks, or tables, views, triggers or indices
/// that differ; "" if it is one. To be asked before anything else is read.
/// @throws SqliteError if the file is damaged
std::string SchemaProblem(SqliteDb* db);

}  // namespace flexarm
