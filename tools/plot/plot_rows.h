#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tools/plot/plot_data.h"

namespace flexarm {

/// Columns of the curves of a run. Those of two joints or links stand side by side.
enum PlotColumn : std::size_t {
  kTimeColumn = 0,
  kReferenceColumn = 1,
  kAngleColumn = 3,
  kAskedColumn = 5,
  kAppliedColumn = 7,
  kGatedColumn = 9,
  kStrainColumn = 11,  ///< percent of the limit
  kDeflectionColumn = 13,
  kTargetColumn = 15,
  kPayloadColumn = 16,
  kSigmaColumn = 17,
  kPlotColumns = 18,
};

/// Key of each column on a page of a run, with its unit.
extern const std::array<const char*, kPlotColumns> kPlotKeys;

using PlotRow = std::array<double, kPlotColumns>;

/// The samples of a run as rows, in order of time. Where samples are missing, a row of NaN stands
/// between, so that no curve crosses the gap.
///
/// More than `most` samples become `most` rows: the time is divided into most / 2 parts, and of
/// each part two rows hold the least and the greatest value of each column, and both the greatest
/// sigma. No peak is lost.
std::vector<PlotRow> PlotRows(const PlotRun& run, std::size_t most);

/// Least and greatest finite value of some columns.
struct ValueRange {
  double low, high;  ///< in the unit of the columns
  bool empty() const { return low > high; }
};
/// Of `columns` columns from `column` on.
ValueRange RangeOf(const std::vector<PlotRow>& rows, std::size_t column, std::size_t columns = 1);

/// A step of 1, 2 or 5 times a power of ten that divides a range into at most `parts` parts.
double NiceStep(double range, int parts);

}  // namespace flexarm
