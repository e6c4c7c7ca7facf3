#pragma once

#include <ostream>
#include <vector>

#include "controller/runlog/decoded_columns.h"

namespace flexarm {

/// With what every decoded file begins.
inline constexpr const char* kDecodedMark = "tick,time_s,state,";

/// Writes the decoded columns of a run as CSV: a row of names, a row of units, a row a sample.
/// Numbers have the shortest decimals that give the same double; NaN is one that is not known.
class DecodedCsvWriter {
 public:
  /// Writes the names and the units.
  DecodedCsvWriter(std::ostream* out, const DecodedRun& run);
  void Row(const DecodedSample& sample);

 private:
  std::ostream* out_;
  std::vector<DecodedColumn> columns_;
};

}  // namespace flexarm
