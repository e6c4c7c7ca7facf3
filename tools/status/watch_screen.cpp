#include "tools/status/watch_screen.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "tools/status/gauge_panel.h"

namespace flexarm {
namespace {

/// A part of the screen. The one of the highest rank is left out first; rank 0 stays.
struct Part {
  int rank;
  bool above;  ///< the panel
  Rows rows;
  bool shown = false;
};

/// Which parts a size of the panel may not displace: those up to this rank.
struct Choice {
  PanelSize panel;
  int keeps;
};
constexpr std::array<Choice, 3> kChoices = {{{.panel = PanelSize::kBars, .keeps = 3},
                                             {.panel = PanelSize::kTens, .keeps = 2},
                                             {.panel = PanelSize::kRoots, .keeps = 1}}};
constexpr int kHighestRank = 6;

std::vector<Part> PartsOf(const WatchedStatus& watched, int columns) {
  const Reply& s = watched.status;
  const int header_rank = watched.no_answer.empty() ? 2 : 0;
  return {{.rank = header_rank, .above = true, .rows = HeaderRows(watched, columns)},
          {.rank = 0, .above = true, .rows = StateRows(s, columns)},
          {.rank = 0, .above = true, .rows = TripRows(s, columns)},
          {.rank = 0, .above = true, .rows = LampRows(s, columns)},
          {.rank = 1, .above = true, .rows = JointRows(s, columns)},
          {.rank = 3, .above = false, .rows = EncoderRows(s, columns)},
          {.rank = 6, .above = false, .rows = PayloadRows(s)},
          {.rank = 6, .above = false, .rows = TelemetryRows(s)},
          {.rank = 6, .above = false, .rows = HealthRows(s)},
          {.rank = 4, .above = false, .rows = BusRows(s, columns)},
          {.rank = 5, .above = false, .rows = ThreadRows(s, columns)}};
}

// Marks the parts that fit into so many rows, by rank.
// @returns the rows that are left; negative: not even those up to `keeps` fit
int Choose(int rows, int keeps, std::vector<Part>* parts) {
  for (int rank = 0; rank <= kHighestRank; ++rank) {
    for (Part& part : *parts) {
      if (part.rank != rank) continue;
      const int needed = static_cast<int>(part.rows.size());
      part.shown = rank <= keeps || needed <= rows;
      if (part.shown) rows -= needed;
    }
  }
  return rows;
}

void Append(const std::vector<Part>& parts, bool above, Rows* rows) {
  for (const Part& part : parts) {
    if (part.shown && part.above == above) {
      rows->insert(rows->end(), part.rows.begin(), part.rows.end());
    }
  }
}

Rows Composed(const WatchedStatus& watched, const ScreenSize& size, bool utf8) {
  std::vector<Part> parts = PartsOf(watched, size.columns);
  Rows rows;
  for (const Choice& choice : kChoices) {
    const int least = PanelRows(watched.status, choice.panel, size.columns);
    const int left = Choose(size.rows - least, choice.keeps, &parts);
    if (left < 0) continue;
    // A third of the columns: then the drawing of the arm is as large as its width permits.
    const int high = std::clamp(size.columns / 3, least, least + left);
    Append(parts, true, &rows);
    const Rows panel = Panel(watched.status, choice.panel, size.columns, high, utf8);
    rows.insert(rows.end(), panel.begin(), panel.end());
    Append(parts, false, &rows);
    return rows;
  }
  Choose(size.rows, 0, &parts);
  Append(parts, true, &rows);
  return rows;
}

}  // namespace

std::vector<std::string> WatchScreen(const WatchedStatus& watched, const ScreenSize& size,
                                     const ScreenStyle& style) {
  const bool nothing = !watched.status.is_object();
  const Rows rows =
      nothing ? HeaderRows(watched, size.columns) : Composed(watched, size, style.utf8);
  std::vector<std::string> lines;
  for (const StyledRow& row : rows) {
    if (static_cast<int>(lines.size()) == size.rows) break;
    lines.push_back(row.Text(size.columns, style));
  }
  return lines;
}

}  // namespace flexarm
