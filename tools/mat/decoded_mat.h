#pragma once

#include <string>
#include <vector>

#include "controller/runlog/decoded_columns.h"

namespace flexarm {

/// With what every MAT file of decoded samples begins.
inline constexpr const char* kDecodedMatMark = "MATLAB 5.0 MAT-file, decoded samples of flexarm";

/// The decoded columns of a run as a MAT file, version 5, compressed (libmatio).
///
/// A variable a column, of its name: a column of doubles, or for a text (`state`) a matrix of
/// characters, a row a sample, filled up with blanks. Variable `units` is a struct with the unit of
/// each of them. NaN is a value that is not known.
class DecodedMat {
 public:
  explicit DecodedMat(const DecodedRun& run);
  void Row(const DecodedSample& sample);
  /// The bytes of the file. @throws std::runtime_error if libmatio fails
  std::string Bytes() const;

 private:
  struct Values {
    std::vector<double> number;
    std::vector<std::string> text;
  };

  std::vector<DecodedColumn> columns_;
  std::vector<Values> values_;  // by column
};

}  // namespace flexarm
