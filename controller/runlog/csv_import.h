#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "controller/law/step_types.h"
#include "hal/sensor_config.h"
#include "model/problem.h"

namespace flexarm {

/// One column of somebody else's CSV file, and what of the rig it holds: [[csv.column]].
///
/// value in SI = scale * unit * cell + offset.
struct CsvColumn {
  std::string column;  ///< its name in the header
  double unit;         ///< key `unit`: SI of a cell of 1: pi/180 for "deg"
  double scale;        ///< SI of the target an SI of the column, not 0: 8.9 N m a A; 1: the same
  double offset;       ///< in SI of the target; 0 if the file has no such key
  /// "time" (s), "hub1" "hub2" "rotor1" "rotor2" (rad), "torque_1" "torque_2" (N m, at the gearbox
  /// output), or a strain channel by its name in our own files, "strain_1_01" (V at the converter).
  std::string target;

  friend bool operator==(const CsvColumn&, const CsvColumn&) = default;
};

/// How to read what another recorder wrote: table [csv].
struct CsvImport {
  int decimation;  ///< rows a period of the loop
  std::vector<CsvColumn> column;

  /// Broken rules: the time, both torques and every sensor of the rig have one column each.
  std::vector<Problem> Problems(const SensorConfig& sensors) const;

  friend bool operator==(const CsvImport&, const CsvImport&) = default;
};

/// Reads such a file: what the rig's converters would have shown at every decimation-th row.
///
/// Angles and voltages become counts by the scales of the rig's own encoders and converter, rails
/// included. Torques are what was applied: the mean of the linear interpolation between the rows
/// since the tick before. Inputs are CsvInput's, readings all valid.
/// @param period_s  of the loop; the rows are a decimation-th of it apart, to 10 %
/// @throws InputError "file:line: column: found .., expected .."
std::vector<StepInput> ReadForeignCsv(const std::filesystem::path& file, const CsvImport& import,
                                      const SensorConfig& sensors, double period_s);

/// Our own file (its header has a column `valid`), or else one that `import`, if there, describes.
std::vector<StepInput> ReadAnyCsv(const std::filesystem::path& file, const CsvImport* import,
                                  const SensorConfig& sensors, double period_s);

}  // namespace flexarm
