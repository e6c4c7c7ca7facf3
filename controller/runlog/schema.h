#pragma once

#include <cstdint>

namespace flexarm {

// The tables of a run log. One SQLite file is one run.
//
// Columns are for people and their tools, in the units of their names; the BLOBs hold the same
// records to the bit (SQLite's REAL loses NaN), for replay. A column is NULL where a number is not
// one, or not known.

inline constexpr std::int64_t kRunLogApplicationId = 0x466c4172;  ///< "FlAr"
inline constexpr std::int64_t kRunLogSchemaVersion = 1;           ///< PRAGMA user_version

inline constexpr const char* kRunLogSchema = R"sql(
CREATE TABLE run (
  key TEXT PRIMARY KEY,
  value TEXT NOT NULL
) WITHOUT ROWID;

CREATE TABLE tick (
  tick INTEGER PRIMARY KEY,
  time_s REAL,
  state TEXT,
  hub_1_deg REAL, hub_2_deg REAL, rotor_1_deg REAL, rotor_2_deg REAL,
  reference_1_deg REAL, reference_2_deg REAL,
  torque_asked_1_nm REAL, torque_asked_2_nm REAL,
  torque_applied_1_nm REAL, torque_applied_2_nm REAL,
  modal_11_m REAL, modal_12_m REAL, modal_21_m REAL, modal_22_m REAL,
  adaptive_gain_change REAL, lyapunov_nm2 REAL,
  saturated_1_s REAL, saturated_2_s REAL,
  payload_kg REAL, payload_sigma_kg REAL,
  friction_1_nm REAL, friction_2_nm REAL, mean_nis REAL, delay_found INTEGER, planned INTEGER,
  counter_1 INTEGER, counter_2 INTEGER, counter_3 INTEGER, counter_4 INTEGER,
  faults INTEGER, limits INTEGER,
  truth_known INTEGER,
  truth_hub_1_rad REAL, truth_hub_2_rad REAL,
  truth_tip_x_m REAL, truth_tip_y_m REAL,
  truth_deflection_1_m REAL, truth_deflection_2_m REAL,
  input BLOB NOT NULL,
  output BLOB NOT NULL
);

CREATE TABLE timing (
  tick INTEGER,
  due_ns INTEGER, woke_ns INTEGER, finished_ns INTEGER,
  late_us REAL, took_us REAL
);

CREATE TABLE event (
  number INTEGER PRIMARY KEY,
  time_ns INTEGER,
  time_s REAL,
  kind TEXT, name TEXT, text TEXT,
  value_json TEXT
);
)sql";

// Keys of table `run`. `result` is there once the run was closed.
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
inline constexpr const char* kResult = "result";
}  // namespace run_key

}  // namespace flexarm
