#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "controller/runlog/csv_rows.h"

namespace flexarm {

/// Rows of a CSV file of another recorder at the samples of the loop, in SI units.
struct CsvSamples {
  std::vector<double> time_s;
  std::vector<int> line;                   ///< in the file, of the row at or before the sample
  std::vector<std::vector<double>> value;  ///< by column of the import, by sample; NaN: not read
  std::vector<std::array<double, 2>> torque_nm;  ///< mean over the period before the sample
  std::int64_t rows_left_out = 0;                ///< those whose time did not advance
  std::int64_t samples_not_read = 0;             ///< samples at which a sensor counts as not read
  double longest_gap_s = 0.0;                    ///< between readings of a sensor
};

/// Every import.decimation-th row. The torque is the mean of the linear interpolation between rows.
CsvSamples Decimated(const CsvRows& rows, const CsvImport& import);

/// Linear interpolation between the readings of each column, every period from the first row on
/// that every sensor has begun by. Between readings farther apart than the bound (LongestGap_s), a
/// sensor is not read; torques are interpolated all the same.
/// @throws InputError if the rows are farther apart than that, or a column has no reading
CsvSamples Resampled(const CsvTable& table, const CsvRows& rows, const CsvImport& import,
                     double period_s);

/// import.longest_gap_s, or if that is 0, two periods.
double LongestGap_s(const CsvImport& import, double period_s);

}  // namespace flexarm
