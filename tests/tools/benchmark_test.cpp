#include "tools/benchmark/benchmark.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

namespace flexarm {
namespace {

constexpr const char* kExperiments = FLEXARM_SOURCE_DIR "/config/experiments";

SweepPlan Plan(const std::string& laws, const std::string& seeds) {
  return BenchmarkPlan(LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml"), kExperiments, laws,
                       seeds);
}

SweepRow Made(std::size_t point, double settling_s) {
  SweepRow row{.point = point, .completed = true, .trip = {}, .refused = {}, .ticks = 801};
  row.measure.fill(1.0);
  row.measure[kSettling] = settling_s;
  return row;
}

TEST(BenchmarkPlan, RunsEveryLawInEveryScenarioWithEverySeed) {
  const SweepPlan plan = Plan("", "1..3");
  EXPECT_EQ(plan.grid.size(), BenchmarkLaws().size() * plan.scenarios.size() * 3);
  std::set<std::string> names;
  for (const Scenario& scenario : plan.scenarios) names.insert(scenario.name);
  EXPECT_EQ(names.size(), plan.scenarios.size());
}

// Each scenario is another run than the nominal one, and what differs is where it says.
TEST(BenchmarkPlan, EveryScenarioIsAnotherSituation) {
  const SweepPlan plan = Plan("sobel", "1");
  const SweepRow nominal = RunPoint(plan, 0);
  EXPECT_TRUE(nominal.completed);
  for (std::size_t point = 1; point < plan.grid.size(); ++point) {
    SweepRow row = RunPoint(plan, point);
    row.point = 0;
    EXPECT_FALSE(SameOutcome(row, nominal)) << plan.scenarios[point].name;
    EXPECT_GT(row.ticks, 0) << plan.scenarios[point].name << ": " << row.refused;
  }
}

TEST(BenchmarkPlan, AScenarioChangesThePlantAndNotTheController) {
  const SweepPlan plan = Plan("sobel", "1");
  for (std::size_t point = 0; point < plan.grid.size(); ++point) {
    const SimulationRequest request = RequestAt(plan, point);
    EXPECT_EQ(request.config.arm.payload_mass_kg, 0.1);
    EXPECT_EQ(request.payload_kg, plan.scenarios[point].payload_kg);
    EXPECT_EQ(request.experiment.name, plan.scenarios[point].experiment.name);
  }
}

// The rests of benchmark-square last 7 s: settling in 1.4 s is 80 % of rest; a trip and a tip that
// never rests are none.
TEST(BenchmarkTable, TheScoreIsTheShareOfTheRestInWhichTheTipRests) {
  const SweepPlan plan = Plan("sobel", "1..4");
  std::vector<SweepRow> rows = {Made(0, 1.4), Made(1, 0.0), Made(2, std::nan("")), Made(3, 0.7)};
  rows[3].completed = false;
  rows[3].trip = "strain-limit";
  const BenchmarkTable table = TableOf(plan, rows);
  const BenchmarkCell& cell = table.cell[0][0];
  EXPECT_NEAR(cell.score, (80.0 + 100.0) / 4.0, 1e-12);
  EXPECT_EQ(cell.group.runs, 4U);
  EXPECT_EQ(cell.group.completed, 3U);
  EXPECT_EQ(cell.group.trips, (std::vector<std::string>{"strain-limit"}));
  EXPECT_EQ(cell.group.median[kSettling], 1.4);  // of 0, 1.4 and never
  EXPECT_EQ(table.Completed(0), 3U);
  EXPECT_EQ(table.Runs(0), 4U);
  // Every other scenario has no run: 0.
  EXPECT_NEAR(table.Score(0), cell.score / static_cast<double>(plan.scenarios.size()), 1e-12);
  EXPECT_NE(table.WorstScenario(0), 0U);
}

TEST(BenchmarkJson, TellsATripFromARefusal) {
  std::vector<SweepRow> rows = {Made(0, 1.4), Made(1, 1.4)};
  rows[0].completed = rows[1].completed = false;
  rows[0].trip = "strain-limit";
  rows[1].refused = "no such design";
  const auto json = BenchmarkJson(TableOf(Plan("sobel", "1..2"), rows));
  const auto& nominal = json["laws"][0]["scenarios"]["nominal"];
  EXPECT_EQ(nominal["trips"], nlohmann::ordered_json({"strain-limit"}));
  EXPECT_EQ(nominal["refused"], nlohmann::ordered_json({"no such design"}));
}

TEST(BenchmarkPage, SaysNeverAndHowManyCompleted) {
  const SweepPlan plan = Plan("sobel", "1..2");
  std::vector<SweepRow> rows = {Made(0, std::nan("")), Made(1, std::nan(""))};
  rows[1].completed = false;
  const std::string page = BenchmarkMarkdown(TableOf(plan, rows));
  EXPECT_NE(page.find("never (1/2)"), std::string::npos) << page;
}

}  // namespace
}  // namespace flexarm
