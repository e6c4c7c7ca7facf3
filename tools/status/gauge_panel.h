#pragma once

#include <cstdint>

#include "tools/status/reply.h"
#include "tools/status/styled_row.h"

// The strain gauges and the drawing of the arm, which share the middle of the screen. Pure
// functions.

namespace flexarm {

/// How much of them there is room for.
enum class PanelSize : std::uint8_t {
  kRoots,  ///< a row a link: strain at the root
  kTens,   ///< and a row with each gauge in tenths of the converter's range
  kBars,   ///< a bar each gauge, and the arm beside them
};

/// The least rows of a panel.
int PanelRows(const Reply& status, PanelSize size, int columns);

/// The panel in exactly `rows` rows, not fewer than PanelRows; what is left shows the arm.
Rows Panel(const Reply& status, PanelSize size, int columns, int rows, bool utf8);

}  // namespace flexarm
