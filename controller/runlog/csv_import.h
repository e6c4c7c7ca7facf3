#pragma once

#include <filesystem>
#include <vector>

#include "controller/types/csv_import_config.h"
#include "controller/types/step_types.h"
#include "hal/sensor_config.h"
#include "model/problem.h"

namespace flexarm {

/// Checks `import`: the time, both torques and every sensor of the rig must have one column each.
/// @returns the broken rules
std::vector<Problem> ProblemsOf(const CsvImport& import, const SensorConfig& sensors);

/// Reads a CSV file of another recorder (CsvImport) and converts every decimation-th row to the
/// readings of the rig's converters.
///
/// Angles and voltages become counts by the scales of the rig's own encoders and converter, with
/// saturation. Torques are those applied: the mean of the linear interpolation between the rows
/// since the tick before. Inputs are those of CsvInput, with all readings valid.
/// @param period_s  of the loop; the rows must be a decimation-th of it apart, to 10 %
/// @throws InputError "file:line: column: found .., expected .."
std::vector<StepInput> ReadForeignCsv(const std::filesystem::path& file, const CsvImport& import,
                                      const SensorConfig& sensors, double period_s);

/// Reads our own format (the header has a column `valid`), or else the one that `import` describes.
std::vector<StepInput> ReadAnyCsv(const std::filesystem::path& file, const CsvImport* import,
                                  const SensorConfig& sensors, double period_s);

}  // namespace flexarm
