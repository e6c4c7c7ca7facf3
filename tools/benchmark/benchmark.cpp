#include "tools/benchmark/benchmark.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "controller/runlog/errors.h"
#include "controller/runlog/metrics.h"
#include "tools/runs/run_summary.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

double ShortestRest_s(const Scenario& scenario) {
  if (scenario.random) return kRandomMovesRest_s;
  double shortest_s = std::numeric_limits<double>::infinity();
  for (const Rest& rest : RestsOf(scenario.experiment, scenario.experiment.duration_s)) {
    shortest_s = std::min(shortest_s, rest.end_s - rest.start_s);
  }
  return shortest_s;
}

double ScoreOf(const SweepRow& row, double rest_s) {
  const double settling_s = row.measure[kSettling];
  if (!row.completed || std::isnan(settling_s)) return 0.0;
  return 100.0 * std::max(0.0, 1.0 - settling_s / rest_s);
}

BenchmarkCell CellOf(const std::vector<std::size_t>& index, const std::vector<SweepRow>& rows,
                     double rest_s) {
  BenchmarkCell cell{.group = GroupOf(index, rows), .rests = RestFiguresOf(rows), .score = 0.0};
  for (const SweepRow& row : rows) {
    cell.score += ScoreOf(row, rest_s) / static_cast<double>(rows.size());
  }
  return cell;
}

nlohmann::ordered_json BoundJson(const RestFigures& rests) {
  return {{"first_at_rest_over_bound", NumberOrNull(rests.at_rest_over_bound[0])},
          {"later_at_rest_over_bound", NumberOrNull(rests.at_rest_over_bound[1])},
          {"first_on_target_over_bound", NumberOrNull(rests.on_target_over_bound[0])},
          {"later_on_target_over_bound", NumberOrNull(rests.on_target_over_bound[1])},
          {"at_rest", rests.at_rest},
          {"on_target", rests.on_target}};
}

nlohmann::ordered_json CellJson(const BenchmarkCell& cell) {
  nlohmann::ordered_json json = GroupJson(cell.group);
  json["score"] = cell.score;
  const RestFigures& rests = cell.rests;
  json["settled_in_time"] = rests.settled_in_time;
  json["latest_settling_s"] = NumberOrNull(rests.latest_settling_s);
  json["target_error_max_mm"] = NumberOrNull(rests.target_error_max_mm);
  json["residual_mean_mm"] = NumberOrNull(rests.residual_mean_mm);
  json["residual_max_mm"] = NumberOrNull(rests.residual_max_mm);
  json["motion_mean_mm"] = NumberOrNull(rests.motion_mean_mm);
  json["motion_max_mm"] = NumberOrNull(rests.motion_max_mm);
  if (!std::isnan(rests.at_rest_over_bound[1])) json.update(BoundJson(rests));
  json["rms_mean_deg"] = {NumberOrNull(rests.rms_mean_deg[0]), NumberOrNull(rests.rms_mean_deg[1])};
  return json;
}

void RefuseLeftOut(const BenchmarkSet& set, const std::vector<std::string>& laws) {
  for (const LeftOut& out : set.left_out) {
    const bool is_asked = std::find(laws.begin(), laws.end(), out.name) != laws.end();
    if (is_asked || laws.empty()) throw InputError("--laws " + out.name + ": " + out.why);
  }
}

}  // namespace

SweepPlan BenchmarkPlan(const RigConfig& config, const BenchmarkSet& set, const std::string& laws,
                        const std::string& seeds) {
  const std::vector<std::string> chosen = laws.empty() ? set.laws : ParseValues(laws);
  RefuseLeftOut(set, chosen);
  SweepPlan plan{.config = config, .experiment = {}, .grid = {}, .scenarios = set.scenarios};
  plan.experiment = plan.scenarios.front().experiment;
  std::vector<std::string> names;
  for (const Scenario& scenario : plan.scenarios) names.push_back(scenario.name);
  plan.grid =
      SweepGrid({{.target = AxisTarget::kConfig, .key = "controller.name", .values = chosen},
                 {.target = AxisTarget::kScenario, .key = {}, .values = names},
                 {.target = AxisTarget::kSeed,
                  .key = {},
                  .values = ParseValues(seeds.empty() ? set.seeds : seeds)}});
  CheckPlan(plan);
  return plan;
}

double BenchmarkTable::Score(std::size_t law) const {
  double sum = 0.0;
  for (const BenchmarkCell& c : cell[law]) sum += c.score;
  return sum / static_cast<double>(cell[law].size());
}

std::size_t BenchmarkTable::WorstScenario(std::size_t law) const {
  const auto lowest =
      std::min_element(cell[law].begin(), cell[law].end(),
                       [](const auto& a, const auto& b) { return a.score < b.score; });
  return static_cast<std::size_t>(lowest - cell[law].begin());
}

std::size_t BenchmarkTable::Completed(std::size_t law) const {
  std::size_t sum = 0;
  for (const BenchmarkCell& c : cell[law]) sum += c.group.completed;
  return sum;
}

std::size_t BenchmarkTable::Runs(std::size_t law) const {
  std::size_t sum = 0;
  for (const BenchmarkCell& c : cell[law]) sum += c.group.runs;
  return sum;
}

BenchmarkTable TableOf(const BenchmarkSet& set, const SweepPlan& plan,
                       const std::vector<SweepRow>& rows) {
  const std::vector<SweepAxis>& axes = plan.grid.axes();
  BenchmarkTable table{.kind = set.kind,
                       .laws = axes[0].values,
                       .scenarios = plan.scenarios,
                       .cell = {},
                       .left_out = set.left_out};
  std::vector<std::vector<std::vector<SweepRow>>> of_cell(
      table.laws.size(), std::vector<std::vector<SweepRow>>(table.scenarios.size()));
  for (const SweepRow& row : rows) {
    const std::vector<std::size_t> index = plan.grid.Indices(row.point);
    of_cell[index[0]][index[1]].push_back(row);
  }
  for (std::size_t law = 0; law < table.laws.size(); ++law) {
    table.cell.emplace_back();
    for (std::size_t i = 0; i < table.scenarios.size(); ++i) {
      table.cell[law].push_back(
          CellOf({law, i}, of_cell[law][i], ShortestRest_s(table.scenarios[i])));
    }
  }
  return table;
}

nlohmann::ordered_json BenchmarkJson(const BenchmarkTable& table) {
  nlohmann::ordered_json json{{"table", ToString(table.kind)},
                              {"laws", nlohmann::ordered_json::array()}};
  for (std::size_t law = 0; law < table.laws.size(); ++law) {
    const std::size_t worst = table.WorstScenario(law);
    nlohmann::ordered_json of_law{{"name", table.laws[law]},
                                  {"score", table.Score(law)},
                                  {"worst_scenario", table.scenarios[worst].name},
                                  {"worst_score", table.cell[law][worst].score},
                                  {"runs", table.Runs(law)},
                                  {"completed", table.Completed(law)},
                                  {"scenarios", nlohmann::ordered_json::object()}};
    for (std::size_t i = 0; i < table.scenarios.size(); ++i) {
      of_law["scenarios"][table.scenarios[i].name] = CellJson(table.cell[law][i]);
    }
    json["laws"].push_back(of_law);
  }
  json["left_out"] = nlohmann::ordered_json::array();
  for (const LeftOut& out : table.left_out) {
    json["left_out"].push_back({{"name", out.name}, {"why", out.why}});
  }
  return json;
}

}  // namespace flexarm
