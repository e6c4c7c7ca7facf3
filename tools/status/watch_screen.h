#pragma once

#include <string>
#include <vector>

#include "tools/status/watch_rows.h"

namespace flexarm {

/// Of a terminal, both at least 1.
struct ScreenSize {
  int columns, rows;
};

/// The screen of `flexarm status --watch`: `size.rows` lines at most, each of `size.columns`
/// columns at most, without newlines. What does not fit is left out, the least urgent first; state,
/// trip and lamps stay the longest. Pure function.
std::vector<std::string> WatchScreen(const WatchedStatus& watched, const ScreenSize& size,
                                     const ScreenStyle& style);

}  // namespace flexarm
