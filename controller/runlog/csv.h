#pragma once

#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "controller/runlog/csv_table.h"
#include "controller/types/step_types.h"
#include "hal/sensor_config.h"

namespace flexarm {

// CSV format of the inputs of a run:
//   time_s, counter_1..counter_4, strain_1_01.., strain_2_01.., valid, torque_1_nm, torque_2_nm
// and, for a rig with that sensor, tip_acceleration before `valid`. Counters, strain channels and
// the accelerometer are raw counts; torques are those applied up to the sample. `valid` is 1 if
// every reading is valid, 0 if none is, otherwise a mask in hexadecimal: bits 0..3 are the
// counters, bit 4 + i is strain channel i in the order of the config, the next one the
// accelerometer.

/// The shortest decimals that give the same double.
std::string CsvNumber(double value);

/// True for a file of DecodedCsvWriter (decoded_csv.h), which lacks what a replay needs.
bool IsDecoded(const CsvTable& table);

/// Names of the strain columns in the order of the config: link, then number within the link.
std::vector<std::string> StrainColumns(const SensorConfig& sensors);

/// The columns that a file for this rig has.
std::vector<std::string> OwnColumns(const SensorConfig& sensors);

/// Writes inputs as CSV. Numbers are written with full precision.
class CsvWriter {
 public:
  /// Writes the header. @param start_ns  time_s = 0, in the clock of the loop
  CsvWriter(std::ostream* out, const SensorConfig& sensors, std::int64_t start_ns);
  void Row(const StepInput& input);

 private:
  std::ostream* out_;
  std::vector<std::string> strain_columns_;
  bool has_tip_;
  std::uint64_t readings_;  // bits of `valid` if all sensors were read
  std::int64_t start_ns_;
};

inline constexpr double kLongestCsv_s = 1e8;  ///< three years; beyond, nanoseconds are lost

/// A row of a CSV file at time_s as an input without readings: state Running, zero references; the
/// first input resets the loop. The tick is the time since the first row in periods, rounded.
StepInput CsvInput(double time_s, double period_s, const std::vector<StepInput>& before);

/// Reads such a file; the order of the columns is free, and unknown columns are ignored. Inputs are
/// those of CsvInput. Lines that begin with # are skipped.
/// @param period_s  of the loop
/// @throws InputError "file:line: column: found .., expected .."; for a decoded file
///   (decoded_csv.h) with the command that writes a raw one
std::vector<StepInput> ReadCsv(const std::filesystem::path& file, const SensorConfig& sensors,
                               double period_s);

}  // namespace flexarm
