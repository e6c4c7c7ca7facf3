#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>

#include "tools/benchmark/benchmark.h"

namespace flexarm {
namespace {

constexpr std::size_t kNominal = 0;  // of the scenarios

std::string Number(double value, const char* format) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "not settled";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string Line(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + cell + " |";
  return line + "\n";
}

std::string Markdown(const TextTable& table) {
  std::string text = Line(table.head) + "|";
  for (std::size_t i = 0; i < table.head.size(); ++i) text += "---|";
  text += "\n";
  for (const auto& row : table.rows) text += Line(row);
  return text;
}

std::string Share(std::size_t part, std::size_t whole) {
  return std::to_string(part) + "/" + std::to_string(whole);
}

std::string Pair(double a, double b, const char* format) {
  return Number(a, format) + " " + Number(b, format);
}

// The settling time of a cell, or why there is none.
std::string Settling(const BenchmarkCell& cell) {
  const SweepGroup& group = cell.group;
  std::string text = Number(group.median[kSettling], "%.2f");
  if (group.completed < group.runs) {
    text += " (" + Share(group.completed, group.runs) + ")";
  }
  return text;
}

// One row per law: score, worst scenario, and the figures of the nominal one.
TextTable LawTable(const BenchmarkTable& table) {
  TextTable text{.head = {"law", "score", "lowest", "in", "completed", "settling, s", "rms, deg",
                          "final, deg", "off target, mm", "residual, mm", "torque rms, N m"},
                 .rows = {}};
  for (std::size_t law = 0; law < table.laws.size(); ++law) {
    const std::size_t worst = table.WorstScenario(law);
    const auto& m = table.cell[law][kNominal].group.median;
    text.rows.push_back({table.laws[law], Number(table.Score(law), "%.1f"),
                         Number(table.cell[law][worst].score, "%.1f"), table.scenarios[worst].name,
                         Share(table.Completed(law), table.Runs(law)),
                         Settling(table.cell[law][kNominal]), Pair(m[kRms1], m[kRms2], "%.2f"),
                         Pair(m[2], m[3], "%.2f"), Number(m[kTargetError], "%.1f"),
                         Number(m[kResidual], "%.1f"), Pair(m[8], m[9], "%.2f")});
  }
  return text;
}

// How many runs settled in time, their residual, and how many completed if not all did.
std::string InTime(const BenchmarkCell& cell) {
  const SweepGroup& group = cell.group;
  if (!group.refused.empty() && group.completed == 0) return "refused";
  std::string text = Share(cell.rests.settled_in_time, group.runs) + ", " +
                     Number(cell.rests.residual_mean_mm, "%.1f");
  if (group.completed < group.runs) text += " (" + Share(group.completed, group.runs) + ")";
  return text;
}

// Settling, residual, motion and rms of a cell, for the columns of InTimeHead.
std::vector<std::string> RestCells(const BenchmarkCell& cell) {
  const RestFigures& r = cell.rests;
  return {Share(r.settled_in_time, cell.group.runs),
          Number(r.latest_settling_s, "%.2f"),
          Number(r.target_error_max_mm, "%.1f"),
          Pair(r.residual_mean_mm, r.residual_max_mm, "%.1f"),
          Pair(r.motion_mean_mm, r.motion_max_mm, "%.1f"),
          Pair(r.rms_mean_deg[0], r.rms_mean_deg[1], "%.2f")};
}

std::vector<std::string> RestHead() {
  return {"settled in time", "latest, s",  "off target, mm",
          "residual, mm",    "motion, mm", "rms, deg"};
}

std::vector<std::string> Joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// One row per law on the moves: counts over all scenarios, and the figures of the nominal one.
TextTable MoveLawTable(const BenchmarkTable& table) {
  TextTable text{.head = Joined({"law", "score", "completed", "settled in time, all"}, RestHead()),
                 .rows = {}};
  for (std::size_t law = 0; law < table.laws.size(); ++law) {
    std::size_t settled = 0;
    for (const BenchmarkCell& cell : table.cell[law]) settled += cell.rests.settled_in_time;
    text.rows.push_back(
        Joined({table.laws[law], Number(table.Score(law), "%.1f"),
                Share(table.Completed(law), table.Runs(law)), Share(settled, table.Runs(law))},
               RestCells(table.cell[law][kNominal])));
  }
  return text;
}

// One row per scenario, one column per law.
TextTable ScenarioTable(const BenchmarkTable& table, std::string (*says)(const BenchmarkCell&)) {
  TextTable text{.head = Joined({"scenario", "what"}, table.laws), .rows = {}};
  for (std::size_t i = 0; i < table.scenarios.size(); ++i) {
    const Scenario& scenario = table.scenarios[i];
    std::vector<std::string> cells = {scenario.name,
                                      scenario.what + (scenario.tuned_on ? " (tuned on)" : "")};
    for (std::size_t law = 0; law < table.laws.size(); ++law) {
      cells.push_back(says(table.cell[law][i]));
    }
    text.rows.push_back(cells);
  }
  return text;
}

// Runs whose moves all came to rest, and the time of the first and of the later moves over the
// bound; in brackets how many completed if not all did.
std::string OverBound(const BenchmarkCell& cell) {
  const SweepGroup& group = cell.group;
  if (!group.refused.empty() && group.completed == 0) return "refused";
  std::string text =
      Share(cell.rests.at_rest, group.runs) + ", " +
      Pair(cell.rests.at_rest_over_bound[0], cell.rests.at_rest_over_bound[1], "%.2f");
  if (group.completed < group.runs) text += " (" + Share(group.completed, group.runs) + ")";
  return text;
}

// One row per law on the fast moves: counts over all scenarios, figures of the nominal one.
TextTable FastLawTable(const BenchmarkTable& table) {
  TextTable text{.head = {"law", "completed", "at rest", "first", "later", "on target",
                          "first, target", "later, target", "motion, mm"},
                 .rows = {}};
  for (std::size_t law = 0; law < table.laws.size(); ++law) {
    const BenchmarkCell& nominal = table.cell[law][kNominal];
    const RestFigures& r = nominal.rests;
    text.rows.push_back(
        {table.laws[law], Share(table.Completed(law), table.Runs(law)),
         Share(r.at_rest, nominal.group.runs), Number(r.at_rest_over_bound[0], "%.2f"),
         Number(r.at_rest_over_bound[1], "%.2f"), Share(r.on_target, nominal.group.runs),
         Number(r.on_target_over_bound[0], "%.2f"), Number(r.on_target_over_bound[1], "%.2f"),
         Pair(r.motion_mean_mm, r.motion_max_mm, "%.1f")});
  }
  return text;
}

// One row per scenario and law.
TextTable LimitTable(const BenchmarkTable& table) {
  TextTable text{.head = Joined({"scenario", "what", "law"}, RestHead()), .rows = {}};
  for (std::size_t i = 0; i < table.scenarios.size(); ++i) {
    for (std::size_t law = 0; law < table.laws.size(); ++law) {
      text.rows.push_back(
          Joined({table.scenarios[i].name, table.scenarios[i].what, table.laws[law]},
                 RestCells(table.cell[law][i])));
    }
  }
  return text;
}

std::string WithoutDigits(std::string text) {
  std::erase_if(text, [](unsigned char c) { return std::isdigit(c) != 0; });
  return text;
}

// What the rig does not permit, and what was refused before it ran: of reasons that differ in their
// numbers alone the first.
TextTable RefusedTable(const BenchmarkTable& table) {
  TextTable text{.head = {"law or scenario", "why"}, .rows = {}};
  for (const LeftOut& out : table.left_out) text.rows.push_back({out.name, out.why});
  for (std::size_t law = 0; law < table.laws.size(); ++law) {
    std::map<std::string, std::string> reasons;  // by their text without numbers
    for (const BenchmarkCell& cell : table.cell[law]) {
      for (const std::string& why : cell.group.refused) reasons.emplace(WithoutDigits(why), why);
    }
    for (const auto& [kind, why] : reasons) text.rows.push_back({table.laws[law], why});
  }
  return text;
}

std::vector<TablePart> ResultParts(const BenchmarkTable& table) {
  switch (table.kind) {
    case BenchmarkKind::kCommands:
      return {{"Score over all scenarios; the other figures are those of the nominal one, medians "
               "over the seeds:",
               LawTable(table)},
              {"Settling time of the tip in every scenario, s; in brackets the runs that "
               "completed, where not all did:",
               ScenarioTable(table, Settling)}};
    case BenchmarkKind::kMoves:
      return {{"Score, completed runs and runs that settled in time over all scenarios; the other "
               "figures are those of the nominal one: residual and motion mean and largest, rms "
               "mean of joints 1 and 2, over the runs that completed:",
               MoveLawTable(table)},
              {"Runs that settled in time and mean residual, mm, in every scenario; in brackets "
               "the runs that completed, where not all did:",
               ScenarioTable(table, InTime)}};
    case BenchmarkKind::kLimits:
      return {
          {"The result with one limit after the other removed: residual and motion "
           "mean and largest, rms mean of joints 1 and 2:",
           LimitTable(table)}};
    case BenchmarkKind::kFast:
      return {
          {"Time from the start of a move until the tip stays within the distance that counts as "
           "settled, of its resting place and of its target, over the shortest time of a rigid "
           "arm: first moves, at which the payload is unknown, and later ones. Completed runs "
           "over all scenarios; the other figures are those of the nominal one, and of the runs "
           "whose moves all came to rest:",
           FastLawTable(table)},
          {"Runs whose moves all came to rest, and that time over the bound, first and later "
           "moves, in every scenario; in brackets the runs that completed, where not all did:",
           ScenarioTable(table, OverBound)}};
  }
  return {};
}

}  // namespace

std::vector<TablePart> TableParts(const BenchmarkTable& table) {
  std::vector<TablePart> parts = ResultParts(table);
  TextTable refused = RefusedTable(table);
  if (!refused.rows.empty()) {
    parts.push_back({"Left out on this rig, or refused before the run:", std::move(refused)});
  }
  return parts;
}

std::string BenchmarkMarkdown(const BenchmarkTable& table) {
  std::string text;
  for (const TablePart& part : TableParts(table)) {
    text += (text.empty() ? "" : "\n") + part.about + "\n\n" + Markdown(part.table);
  }
  return text;
}

}  // namespace flexarm
