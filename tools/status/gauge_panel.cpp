#include "tools/status/gauge_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "model/units.h"
#include "tools/status/arm_drawing.h"
#include "tools/status/gauge_bar.h"
#include "tools/status/watch_rows.h"

namespace flexarm {
namespace {

constexpr int kLinkColumns = 26;      // of a link's bars, at least
constexpr int kMostLinkColumns = 40;  // more shows no more
constexpr int kNameColumns = 5, kFigureColumns = 6;
constexpr int kLeastArmRows = 7;  // below that an arm is a scribble
constexpr int kNever = 1 << 20;   // rows: more than any screen has
constexpr double kMicrostrain = 1e6;

std::vector<const Reply*> GaugesOf(const Reply& status, std::size_t link) {
  std::vector<const Reply*> gauges;
  for (const Reply& gauge : ListIn(status, "gauges")) {
    if (NumberIn(gauge, "link") == static_cast<double>(link + 1)) gauges.push_back(&gauge);
  }
  return gauges;
}

std::string Microstrain(const Reply& strain) {
  const double value = std::round(NumberOrNan(strain) * kMicrostrain) + 0.0;  // no -0
  if (!std::isfinite(value)) return "-";
  const std::string figure = FigureOf(Reply(value), 0);
  return value < 0.0 ? figure : "+" + figure;
}

bool Used(const Reply& gauge) { return FlagIn(gauge, "used", true); }
bool Stale(const Reply& gauge) { return NumberIn(gauge, "age_ms") >= kStale_ms; }

StyledRow BarRow(const std::string& name, const StyledRow& bar, const std::string& figure,
                 int columns, const char* mark) {
  StyledRow row(name);
  row.PadTo(kNameColumns).Add(bar).PadTo(columns - 2 - static_cast<int>(figure.size()));
  return row.Add(figure).Add(mark, Look::kBad);
}

int BarColumns(int columns) { return columns - kNameColumns - kFigureColumns - 2; }

StyledRow RootRow(const Reply& status, std::size_t link, int columns) {
  const Reply& strain = Element(In(status, "root_strain"), link);
  const double limit = NumberOrNan(Element(In(In(status, "limits"), "root_strain"), link));
  const bool beyond = std::abs(NumberOrNan(strain)) > limit;
  return BarRow("root", GaugeBar(NumberOrNan(strain), limit, BarColumns(columns)),
                Microstrain(strain), columns, beyond ? " !" : "");
}

// The bar is of the converter's range, the figure the strain.
StyledRow GaugeRow(const Reply& gauge, int columns) {
  const std::string full = TextIn(gauge, "name", "-");
  const std::string name = full.size() > 2 ? full.substr(full.size() - 2) : full;
  StyledRow bar = GaugeBar(NumberOrNan(In(gauge, "counts")), NumberOrNan(In(gauge, "counts_limit")),
                           BarColumns(columns));
  if (Stale(gauge)) {
    bar = StyledRow("[").Add(AgeText(NumberIn(gauge, "age_ms") / 1e3) + " old", Look::kBad);
    bar.PadTo(BarColumns(columns) - 1).Add("]");
  }
  return BarRow(name, bar, Microstrain(In(gauge, "strain")), columns,
                Used(gauge) && !Stale(gauge) ? "" : " !");
}

StyledRow LinkTitle(const Reply& status, std::size_t link) {
  const double limit = NumberOrNan(Element(In(In(status, "limits"), "root_strain"), link));
  StyledRow title("link " + std::to_string(link + 1), Look::kTitle);
  if (!std::isfinite(limit)) return title;
  return title.Add(", root limit " + FigureOf(Reply(limit * kMicrostrain), 0));
}

Rows LinkColumn(const Reply& status, std::size_t link, int columns) {
  Rows rows{LinkTitle(status, link), RootRow(status, link, columns)};
  for (const Reply* gauge : GaugesOf(status, link)) rows.push_back(GaugeRow(*gauge, columns));
  return rows;
}

// "+3" is 30 to 39 % of the converter's range, "!!" a gauge that the fit does without.
StyledRow TensRow(const Reply& status, std::size_t link) {
  StyledRow row("   ");
  for (const Reply* gauge : GaugesOf(status, link)) {
    const double share =
        NumberOrNan(In(*gauge, "counts")) / NumberOrNan(In(*gauge, "counts_limit"));
    row.Add(" ");
    if (!Used(*gauge) || Stale(*gauge) || !std::isfinite(share)) {
      row.Add("!!", Look::kBad);
      continue;
    }
    const int tens = static_cast<int>(std::min(std::abs(share) * 10.0, 9.0));
    row.Add((share < 0.0 ? "-" : "+") + std::to_string(tens),
            tens >= 8 ? Look::kCaution : Look::kGood);
  }
  return row;
}

ArmPose PoseOf(const Reply& status) {
  ArmPose pose{};
  for (std::size_t link = 0; link < 2; ++link) {
    pose.length_m[link] = NumberOrNan(Element(In(status, "link_length_m"), link));
    pose.angle_rad[link] = NumberOrNan(Element(In(status, "joint_angle_deg"), link)) / kDegPerRad;
    const Reply& modal = In(status, "modal_m");
    const double tip_m =
        NumberOrNan(Element(modal, 2 * link)) + NumberOrNan(Element(modal, 2 * link + 1));
    pose.bending_m[link] = std::isfinite(tip_m) ? tip_m : 0.0;
  }
  return pose;
}

Rows ArmRows(const Reply& status, int columns, int rows, bool utf8) {
  const ArmPose pose = PoseOf(status);
  if (rows < kLeastArmRows) return {};
  if (!std::isfinite(pose.angle_rad[0]) || !std::isfinite(pose.angle_rad[1])) {
    return WrapWords("no drawing of the arm: an angle is not known", columns);
  }
  Rows drawn{StyledRow("from above, bending x" + FigureOf(Reply(kBendingScale), 0))};
  for (const StyledRow& row : ArmDrawing(pose, columns, rows - 1, utf8)) drawn.push_back(row);
  return drawn;
}

// Blocks of rows side by side, each with its width, a blank apart.
Rows Beside(const std::vector<std::pair<Rows, int>>& blocks, int rows) {
  Rows joined(static_cast<std::size_t>(rows));
  int at = 0;
  for (const auto& [block, columns] : blocks) {
    for (std::size_t i = 0; i < joined.size() && i < block.size(); ++i) {
      joined[i].PadTo(at).Add(block[i]);
    }
    at += columns + 1;
  }
  return joined;
}

int LinkColumnsOf(int columns) {
  return std::clamp((columns - 2) / 3, kLinkColumns, kMostLinkColumns);
}

// Room for a third column, with the arm.
bool ArmBeside(int columns) { return columns >= 3 * kLinkColumns + 2; }

Rows BarsPanel(const Reply& status, int columns, int rows, bool utf8) {
  const bool beside = ArmBeside(columns);
  const int link = beside ? LinkColumnsOf(columns) : (columns - 1) / 2;
  std::vector<std::pair<Rows, int>> blocks{{LinkColumn(status, 0, link), link},
                                           {LinkColumn(status, 1, link), link}};
  const int arm = columns - 2 * link - 2;
  if (beside) blocks.emplace_back(ArmRows(status, arm, rows, utf8), arm);
  Rows all = Beside(blocks, rows);
  if (beside) return all;
  const int bars = PanelRows(status, PanelSize::kBars, columns);
  all.resize(static_cast<std::size_t>(bars));
  for (const StyledRow& row : ArmRows(status, columns, rows - bars, utf8)) all.push_back(row);
  return all;
}

}  // namespace

int PanelRows(const Reply& status, PanelSize size, int columns) {
  if (size == PanelSize::kRoots) return 2;
  if (size == PanelSize::kTens) return 4;
  if (columns < 2 * kLinkColumns + 1) return kNever;
  const std::size_t gauges = std::max(GaugesOf(status, 0).size(), GaugesOf(status, 1).size());
  return 2 + static_cast<int>(gauges);
}

Rows Panel(const Reply& status, PanelSize size, int columns, int rows, bool utf8) {
  if (size == PanelSize::kBars) return BarsPanel(status, columns, rows, utf8);
  Rows all;
  for (std::size_t link = 0; link < 2; ++link) {
    StyledRow row("L" + std::to_string(link + 1) + " ", Look::kTitle);
    const int width = std::min(columns, kMostLinkColumns) - row.width();
    all.push_back(row.Add(RootRow(status, link, width)));
    if (size == PanelSize::kTens) all.push_back(TensRow(status, link));
  }
  const int left = rows - static_cast<int>(all.size());
  for (const StyledRow& row : ArmRows(status, columns, left, utf8)) all.push_back(row);
  return all;
}

}  // namespace flexarm
