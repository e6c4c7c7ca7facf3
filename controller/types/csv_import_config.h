#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "model/units.h"

namespace flexarm {

/// A unit of a column and what a cell of 1 is in SI.
struct CsvUnit {
  std::string_view name;
  double si;

  friend bool operator==(const CsvUnit&, const CsvUnit&) = default;
};

inline constexpr std::array<CsvUnit, 14> kCsvUnits{{{"s", 1.0},
                                                    {"ms", 1e-3},
                                                    {"us", 1e-6},
                                                    {"rad", 1.0},
                                                    {"mrad", 1e-3},
                                                    {"deg", kRadPerDeg},
                                                    {"A", 1.0},
                                                    {"mA", 1e-3},
                                                    {"V", 1.0},
                                                    {"mV", 1e-3},
                                                    {"Nm", 1.0},
                                                    {"mNm", 1e-3},
                                                    {"1", 1.0},
                                                    {"microstrain", 1e-6}}};

/// One column of a CSV file of another recorder, and the rig's quantity in it: [[csv.column]].
///
/// value in SI = scale * unit * cell + offset.
struct CsvColumn {
  std::string column;  ///< its name in the header
  CsvUnit unit;
  double scale;   ///< SI of the target per SI of the column, not 0: 8.9 N m per A; 1: same quantity
  double offset;  ///< in SI of the target; 0 if the file has no such key
  /// "time" (s), "hub1" "hub2" "rotor1" "rotor2" (rad), "torque_1" "torque_2" (N m, at the gearbox
  /// output), or a strain channel by its name in our own files, "strain_1_01" (V at the converter).
  std::string target;

  friend bool operator==(const CsvColumn&, const CsvColumn&) = default;
};

/// How to read a CSV file of another recorder: table [csv].
struct CsvImport {
  int decimation = 1;  ///< rows per period of the loop; not used with `resample`
  char separator = 0;  ///< between cells: comma, semicolon or tab; 0: found from the header
  /// Interpolate rows of any times on the loop's samples, in place of refusing those that are not
  /// a decimation-th of a period apart.
  bool resample = false;
  /// With `resample`: between readings that are farther apart, a sensor counts as not read;
  /// 0: two periods of the loop.
  double longest_gap_s = 0.0;
  std::vector<CsvColumn> column{};

  friend bool operator==(const CsvImport&, const CsvImport&) = default;
};

}  // namespace flexarm
