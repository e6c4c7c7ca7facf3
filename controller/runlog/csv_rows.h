#pragma once

#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "controller/runlog/csv_table.h"
#include "controller/types/csv_import_config.h"

namespace flexarm {

/// The mapped columns of a CSV file of another recorder, whole, in SI units.
struct CsvRows {
  std::vector<int> line;                   ///< of each row in the file
  std::vector<double> time_s;              ///< as in the file
  std::vector<std::vector<double>> value;  ///< by column of the import, by row; NaN: no reading
  bool units_row = false;                  ///< the first row had units, and was skipped
};

/// The column of the import with this target, which there must be.
std::size_t ColumnOf(const CsvImport& import, std::string_view target);

/// Reads all rows. A first row of texts is one of units: a known unit must be that of the config.
/// @param table   at its header, which must have the columns
/// @throws InputError  also for a cell without a reading, unless import.resample
CsvRows ReadRows(CsvTable* table, const CsvImport& import);

/// Median time between rows, s; 0 of a single row.
double TypicalSpacing_s(const std::vector<double>& time_s);

/// The rows must be period_s / decimation apart, each to 10 % of that from its place.
/// @throws InputError that names the line, what is wrong there, and csv.resample
void RequireEvenTimes(const CsvTable& table, const CsvRows& rows, const CsvImport& import,
                      double period_s);

}  // namespace flexarm
