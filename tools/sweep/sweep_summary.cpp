#include "tools/sweep/sweep_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <sstream>

#include "controller/files/external_text.h"
#include "controller/files/write_file.h"
#include "controller/runlog/errors.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

constexpr std::size_t kShownReasons = 400;  // bytes
constexpr const char* kSummaryCsvMark = "runs,completed,trips,refused";

void AddOnce(const std::string& text, std::vector<std::string>* list) {
  if (!text.empty() && std::find(list->begin(), list->end(), text) == list->end()) {
    list->push_back(text);
  }
}

// Positions in the file's axes, in the order of the summary.
std::vector<std::size_t> AxisOrder(const std::vector<SweepAxis>& axes, const std::string& by) {
  std::vector<std::size_t> order;
  std::size_t last = axes.size();
  std::string known;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].target == AxisTarget::kSeed) continue;
    known += (known.empty() ? "" : ", ") + axes[i].Column();
    const bool chosen = by.empty() ? axes[i].values.size() > 1 : axes[i].Column() == by;
    if (chosen && last == axes.size()) {
      last = i;
    } else {
      order.push_back(i);
    }
  }
  if (last != axes.size()) order.push_back(last);
  if (last != axes.size() || by.empty()) return order;
  throw InputError("--by " + by + ": is not an axis of this sweep; expected one of " + known);
}

std::string NumberText(double value) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "never";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", value);
  return text.data();
}

std::vector<std::string> CellsOf(const SweepSummary& summary, const SweepGroup& group) {
  std::vector<std::string> cells;
  for (std::size_t i = 0; i < summary.axes.size(); ++i) {
    cells.push_back(summary.axes[i].values[group.index[i]]);
  }
  cells.push_back(std::to_string(group.completed) + "/" + std::to_string(group.runs));
  for (const std::size_t i : summary.Measured()) cells.push_back(NumberText(group.median[i]));
  return cells;
}

// A missing time of a completed run is longer than every other.
void CountAsNever(std::vector<double>* times) {
  for (double& time : *times) {
    if (std::isnan(time)) time = std::numeric_limits<double>::infinity();
  }
}

std::string Joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : "; ") + part;
  return text;
}

std::string CsvCell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

SweepGroup GroupOf(const std::vector<std::size_t>& index, const std::vector<SweepRow>& rows) {
  SweepGroup group{.index = index, .runs = rows.size(), .trips = {}, .refused = {}};
  std::array<std::vector<double>, kSweepMeasures.size()> values;
  for (const SweepRow& row : rows) {
    AddOnce(row.trip, &group.trips);
    AddOnce(row.refused, &group.refused);
    if (!row.completed) continue;
    ++group.completed;
    for (std::size_t i = 0; i < values.size(); ++i) values[i].push_back(row.measure[i]);
  }
  CountAsNever(&values[kSettling]);
  for (std::size_t i = kFirstAtRest; i < values.size(); ++i) {
    const bool has_value = std::any_of(values[i].begin(), values[i].end(),
                                       [](double ratio) { return !std::isnan(ratio); });
    if (has_value) CountAsNever(&values[i]);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    group.median[i] = MedianOf(values[i]);
    if (values[i].empty()) continue;
    const auto [least, most] = std::minmax_element(values[i].begin(), values[i].end());
    group.least[i] = *least;
    group.most[i] = *most;
  }
  return group;
}

std::vector<std::size_t> SweepSummary::Measured() const {
  std::vector<std::size_t> measured;
  for (std::size_t i = 0; i < kSweepMeasures.size(); ++i) {
    const bool is_bound_ratio = i >= kFirstAtRest;
    const bool has_value = std::any_of(groups.begin(), groups.end(), [i](const SweepGroup& group) {
      return !std::isnan(group.median[i]);
    });
    if (!is_bound_ratio || has_value) measured.push_back(i);
  }
  return measured;
}

double MedianOf(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  if (values.size() % 2 == 1) return values[middle];
  return 0.5 * (values[middle - 1] + values[middle]);
}

SweepSummary Summarise(SweepFile* file, const std::string& by) {
  const std::vector<SweepAxis>& axes = file->grid().axes();
  const std::vector<std::size_t> order = AxisOrder(axes, by);
  const std::vector<SweepRow> rows = file->Rows();
  std::map<std::vector<std::size_t>, std::vector<SweepRow>> grouped;
  for (const SweepRow& row : rows) {
    const std::vector<std::size_t> indices = file->grid().Indices(row.point);
    std::vector<std::size_t> index;
    index.reserve(order.size());
    for (const std::size_t i : order) index.push_back(indices[i]);
    grouped[index].push_back(row);
  }
  SweepSummary summary{
      .axes = {}, .groups = {}, .points = file->grid().size(), .done = rows.size()};
  for (const std::size_t i : order) summary.axes.push_back(axes[i]);
  for (const auto& [index, of_group] : grouped) {
    summary.groups.push_back(GroupOf(index, of_group));
  }
  return summary;
}

nlohmann::ordered_json GroupJson(const SweepGroup& group) {
  nlohmann::ordered_json json{{"runs", group.runs},
                              {"completed", group.completed},
                              {"trips", group.trips},
                              {"refused", group.refused}};
  for (std::size_t i = 0; i < kSweepMeasures.size(); ++i) {
    json[kSweepMeasures[i].column] = NumberOrNull(group.median[i]);
  }
  return json;
}

nlohmann::ordered_json SummaryJson(const SweepSummary& summary) {
  nlohmann::ordered_json json;
  json["points"] = summary.points;
  json["done"] = summary.done;
  json["groups"] = nlohmann::ordered_json::array();
  for (const SweepGroup& group : summary.groups) {
    nlohmann::ordered_json of_group;
    for (std::size_t i = 0; i < summary.axes.size(); ++i) {
      of_group[summary.axes[i].Column()] = summary.axes[i].values[group.index[i]];
    }
    of_group.update(GroupJson(group));
    json["groups"].push_back(of_group);
  }
  return json;
}

void PrintSummary(const SweepSummary& summary) {
  std::vector<std::vector<std::string>> table(1);
  for (const SweepAxis& axis : summary.axes) table[0].push_back(axis.Column());
  table[0].emplace_back("completed");
  for (const std::size_t i : summary.Measured()) table[0].emplace_back(kSweepMeasures[i].title);
  for (const SweepGroup& group : summary.groups) table.push_back(CellsOf(summary, group));
  for (auto& line : table) {
    for (std::string& cell : line) cell = Shown(cell);
  }
  std::vector<std::size_t> width(table[0].size());
  for (const auto& line : table) {
    for (std::size_t i = 0; i < line.size(); ++i) width[i] = std::max(width[i], line[i].size());
  }
  for (std::size_t row = 0; row < table.size(); ++row) {
    for (std::size_t i = 0; i < width.size(); ++i) {
      std::printf("%s%*s", i == 0 ? "" : "  ", static_cast<int>(width[i]), table[row][i].c_str());
    }
    if (row > 0) {
      const SweepGroup& group = summary.groups[row - 1];
      if (!group.trips.empty()) std::printf("  trips: %s", Shown(Joined(group.trips)).c_str());
      if (!group.refused.empty()) {
        std::printf("  refused: %s", Shown(Joined(group.refused), kShownReasons).c_str());
      }
    }
    std::printf("\n");
  }
  std::printf("medians over the completed runs; %zu of %zu points done\n", summary.done,
              summary.points);
}

OutputRules SummaryCsvRules(std::vector<std::filesystem::path> inputs, bool overwrite) {
  return {.kind = "a table of a sweep",
          .mark = kSummaryCsvMark,
          .inputs = std::move(inputs),
          .overwrite = overwrite};
}

void WriteSummaryCsv(const SweepSummary& summary, const std::filesystem::path& output,
                     const OutputRules& rules) {
  std::ostringstream csv;
  for (const SweepAxis& axis : summary.axes) csv << CsvCell(axis.Column()) << ',';
  csv << kSummaryCsvMark;
  for (const SweepMeasure& measure : kSweepMeasures) csv << ',' << measure.column;
  csv << '\n';
  for (const SweepGroup& group : summary.groups) {
    for (std::size_t i = 0; i < summary.axes.size(); ++i) {
      csv << CsvCell(summary.axes[i].values[group.index[i]]) << ',';
    }
    csv << group.runs << ',' << group.completed << ',' << CsvCell(Joined(group.trips)) << ','
        << CsvCell(Joined(group.refused));
    csv.precision(17);
    for (const double median : group.median) {
      csv << ',';
      if (std::isfinite(median)) csv << median;
    }
    csv << '\n';
  }
  WriteFile(output, csv.str(), rules);
}

}  // namespace flexarm
