#pragma once

#include <cstdint>
#include <string>

#include "controller/runlog/sqlite_db.h"
#include "controller/safety/safety_record.h"

namespace flexarm {

inline constexpr std::uint32_t kSafetyRecordVersion = 3;
static_assert(sizeof(SafetyRecord) == 72, "the layout changed: raise kSafetyRecordVersion");

/// Table `safety`: one row per change of the safety facts or state.
inline constexpr const char* kSafetyTable = R"sql(
CREATE TABLE safety (
  number INTEGER PRIMARY KEY,
  time_ns INTEGER,
  time_s REAL,
  state_before TEXT, state_after TEXT, cause TEXT,
  present TEXT,
  all_reported INTEGER, at_rest INTEGER, experiment_done INTEGER, stop_expired INTEGER,
  reset_pressed INTEGER, may_damp INTEGER, drives_on INTEGER, drives_off INTEGER,
  tests_power INTEGER, power_follows INTEGER,
  request TEXT, request_number INTEGER, refusal TEXT,
  evidence_value REAL, evidence_limit REAL, evidence_channel INTEGER,
  record BLOB NOT NULL
);
)sql";

inline constexpr const char* kInsertSafety =
    "INSERT INTO safety VALUES (NULL,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)";
inline constexpr const char* kSelectSafety = "SELECT number, record FROM safety ORDER BY number";

/// Executes a prepared kInsertSafety.
void InsertSafety(SqliteStatement* insert, const SafetyRecord& record, std::int64_t start_ns);

/// Reads the current row of kSelectSafety. @returns the error in it, empty if none
std::string ReadSafety(const SqliteStatement& row, SafetyRecord* record);

/// Machine names of the causes in a set, separated by a space.
std::string CauseNames(TripCauses causes);

}  // namespace flexarm
