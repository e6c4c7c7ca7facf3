#pragma once

#include <string>
#include <vector>

#include "tools/plot/plot_data.h"

namespace flexarm {

/// Text among the first of a page, by which flexarm knows its own.
inline constexpr const char* kRunPageMark = "Drawn by flexarm: a page of runs";

/// One HTML page that shows runs, laid over each other, and needs no other file and no network:
/// curves with values under the pointer, zoom, the arm animated, events, the commands that replay.
///
/// Its size is limited for any duration: at most 4000 rows of values and 600 poses a run, about a
/// megabyte (PlotRows says what happens to longer runs). The page is run_page.html, with the data
/// as JSON: `runs`: [{`columns`: {`time_s`: [..], ..}, ..}], null where there is no value.
std::string RunPage(const std::vector<LoadedRun>& runs);

}  // namespace flexarm
