#pragma once

#include <string>
#include <vector>

namespace flexarm {

/// One column of a CSV file of another recorder, and the rig's quantity in it: [[csv.column]].
///
/// value in SI = scale * unit * cell + offset.
struct CsvColumn {
  std::string column;  ///< its name in the header
  double unit;         ///< key `unit`: SI of a cell of 1: pi/180 for "deg"
  double scale;   ///< SI of the target per SI of the column, not 0: 8.9 N m per A; 1: same quantity
  double offset;  ///< in SI of the target; 0 if the file has no such key
  /// "time" (s), "hub1" "hub2" "rotor1" "rotor2" (rad), "torque_1" "torque_2" (N m, at the gearbox
  /// output), or a strain channel by its name in our own files, "strain_1_01" (V at the converter).
  std::string target;

  friend bool operator==(const CsvColumn&, const CsvColumn&) = default;
};

/// How to read a CSV file of another recorder: table [csv].
struct CsvImport {
  int decimation;  ///< rows per period of the loop
  std::vector<CsvColumn> column;

  friend bool operator==(const CsvImport&, const CsvImport&) = default;
};

}  // namespace flexarm
