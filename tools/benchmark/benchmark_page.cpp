#include <array>
#include <cmath>
#include <cstdio>

#include "tools/benchmark/benchmark.h"

namespace flexarm {
namespace {

constexpr std::size_t kNominal = 0;  // of the scenarios

std::string Number(double value, const char* format) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "never";
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

// What a cell says in one word: how long the tip took, or why there is no such time.
std::string Settling(const BenchmarkCell& cell) {
  const SweepGroup& group = cell.group;
  std::string text = Number(group.median[kSettling], "%.2f");
  if (group.completed < group.runs) {
    text += " (" + std::to_string(group.completed) + "/" + std::to_string(group.runs) + ")";
  }
  return text;
}

}  // namespace

TextTable LawTable(const BenchmarkTable& table) {
  TextTable text{.head = {"law", "score", "lowest", "in", "completed", "settling, s", "rms, deg",
                          "final, deg", "residual, mm", "torque rms, N m"},
                 .rows = {}};
  for (std::size_t law = 0; law < table.laws.size(); ++law) {
    const std::size_t worst = table.WorstScenario(law);
    const auto& m = table.cell[law][kNominal].group.median;
    text.rows.push_back(
        {table.laws[law], Number(table.Score(law), "%.1f"),
         Number(table.cell[law][worst].score, "%.1f"), table.scenarios[worst].name,
         std::to_string(table.Completed(law)) + "/" + std::to_string(table.Runs(law)),
         Settling(table.cell[law][kNominal]), Number(m[0], "%.2f") + " " + Number(m[1], "%.2f"),
         Number(m[2], "%.2f") + " " + Number(m[3], "%.2f"), Number(m[5], "%.1f"),
         Number(m[8], "%.2f") + " " + Number(m[9], "%.2f")});
  }
  return text;
}

TextTable ScenarioTable(const BenchmarkTable& table) {
  TextTable text{.head = {"scenario", "what"}, .rows = {}};
  text.head.insert(text.head.end(), table.laws.begin(), table.laws.end());
  for (std::size_t i = 0; i < table.scenarios.size(); ++i) {
    const Scenario& scenario = table.scenarios[i];
    std::vector<std::string> cells = {scenario.name,
                                      scenario.what + (scenario.tuned_on ? " (tuned on)" : "")};
    for (std::size_t law = 0; law < table.laws.size(); ++law) {
      cells.push_back(Settling(table.cell[law][i]));
    }
    text.rows.push_back(cells);
  }
  return text;
}

std::string BenchmarkMarkdown(const BenchmarkTable& table) {
  return "Score over all scenarios; the other figures are those of the nominal one, medians over\n"
         "the seeds:\n\n" +
         Markdown(LawTable(table)) +
         "\nSettling time of the tip in every scenario, s; in brackets the runs that completed,\n"
         "where not all did:\n\n" +
         Markdown(ScenarioTable(table));
}

}  // namespace flexarm
