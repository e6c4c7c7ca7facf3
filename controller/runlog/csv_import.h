#pragma once

#include <filesystem>
#include <vector>

#include "controller/types/csv_import_config.h"
#include "controller/types/step_types.h"
#include "hal/sensor_config.h"
#include "model/problem.h"

namespace flexarm {

/// Broken rules of `import`: the time, both torques and every sensor of the rig have one column
/// each.
std::vector<Problem> ProblemsOf(const CsvImport& import, const SensorConfig& sensors);

/// Reads a file of another recorder (CsvImport): what the rig's converters would have shown at
/// every decimation-th row.
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
