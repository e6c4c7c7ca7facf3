#include "controller/runlog/decoded_csv.h"

#include <cmath>
#include <string>
#include <string_view>
#include <variant>

#include "controller/runlog/csv.h"

namespace flexarm {
namespace {

// How every reader of CSV files spells a missing number: pandas, NumPy, MATLAB, Octave.
std::string CellOf(double value) { return std::isnan(value) ? "NaN" : CsvNumber(value); }
std::string CellOf(std::int64_t value) { return std::to_string(value); }
std::string CellOf(std::string_view text) { return std::string(text); }

}  // namespace

DecodedCsvWriter::DecodedCsvWriter(std::ostream* out, const DecodedRun& run)
    : out_(out), columns_(DecodedColumns(run)) {
  const char* comma = "";
  for (const DecodedColumn& column : columns_) {
    *out_ << comma << column.name;
    comma = ",";
  }
  comma = "\n";
  for (const DecodedColumn& column : columns_) {
    *out_ << comma << column.unit;
    comma = ",";
  }
  *out_ << '\n';
}

void DecodedCsvWriter::Row(const DecodedSample& sample) {
  const char* comma = "";
  for (const DecodedColumn& column : columns_) {
    *out_ << comma << std::visit([](auto value) { return CellOf(value); }, column.value(sample));
    comma = ",";
  }
  *out_ << '\n';
}

}  // namespace flexarm
