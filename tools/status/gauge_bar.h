#pragma once

#include "tools/status/styled_row.h"

namespace flexarm {

/// A reading as a bar between its limits, "[    |==  ]" with zero in the middle, `columns` wide. At
/// 80 % of the limit it is a caution. Beyond the limit it is bad, and ends in '<' or '>'.
/// @param value  NaN: not known; the bar is empty
/// @param limit  the bar ends at -limit and at +limit; not above 0: not known, and there is no bar
StyledRow GaugeBar(double value, double limit, int columns);

/// The share of a whole as "[####....]", `columns` wide. @param share  cut to 0 .. 1
StyledRow ShareBar(double share, int columns);

}  // namespace flexarm
