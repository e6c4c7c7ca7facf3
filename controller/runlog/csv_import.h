#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "controller/runlog/csv_table.h"
#include "controller/types/csv_import_config.h"
#include "controller/types/step_types.h"
#include "hal/sensor_config.h"
#include "model/problem.h"

namespace flexarm {

/// Checks `import`: the time, both torques and every sensor of the rig must have one column each.
/// @returns the broken rules
std::vector<Problem> ProblemsOf(const CsvImport& import, const SensorConfig& sensors);

/// Which columns of a header a rig's config uses.
struct CsvColumnUse {
  bool own = true;  ///< our own format: columns of raw counts, and one `valid`
  std::vector<std::string> used, unused, missing;
};

/// Reads the header of a CSV file only. @throws InputError
CsvColumnUse ColumnsIn(const std::filesystem::path& file, const CsvImport* import,
                       const SensorConfig& sensors);

/// What was found in a CSV file, for people.
struct CsvFacts {
  bool own = true;  ///< our own format
  char separator = ',';
  bool decimal_comma = false;
  bool units_row = false;
  std::vector<std::string> used, unused;  ///< columns of the header
  std::int64_t rows = 0;
  double duration_s = 0.0;
  double row_spacing_s = 0.0;  ///< median; 0: a single row
  /// With csv.resample: what was done. None: rows were used as they are.
  struct Resampling {
    double longest_gap_s;           ///< the bound on what is interpolated
    double longest_missing_s;       ///< between two readings of a sensor
    std::int64_t rows_left_out;     ///< whose time did not advance
    std::int64_t samples_not_read;  ///< with a sensor that counts as not read
  };
  std::optional<Resampling> resampling;
  /// Readings beyond the range of the converter, by strain channel in the order of the config: the
  /// loop got the end of the range.
  std::array<std::int64_t, kMaxStrainChannels> beyond_range{};
};

/// A CSV file as the inputs of a loop.
struct CsvRun {
  std::vector<StepInput> input;
  /// By input: the readings of the strain channels in counts, neither rounded nor limited to the
  /// range of the converter.
  std::vector<std::array<double, kMaxStrainChannels>> strain_counts;
  CsvFacts facts;
};

/// Reads a CSV file of another recorder (CsvImport) and converts every decimation-th row, or with
/// csv.resample the interpolated ones, to the readings of the rig's converters.
///
/// Angles and voltages become counts by the scales of the rig's own encoders and converter, with
/// saturation. Torques are those applied: the mean of the linear interpolation between the rows
/// since the tick before. Inputs are those of CsvInput.
/// @param period_s  of the loop
/// @throws InputError "file:line: column: found .., expected .."
CsvRun ReadForeignCsv(const std::filesystem::path& file, const CsvImport& import,
                      const SensorConfig& sensors, double period_s);

/// Reads our own format (the header has a column `valid`), or else the one that `import` describes.
CsvRun ReadAnyCsv(const std::filesystem::path& file, const CsvImport* import,
                  const SensorConfig& sensors, double period_s);

}  // namespace flexarm
