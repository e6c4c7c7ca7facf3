#include "tools/benchmark/benchmark.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "controller/runlog/errors.h"
#include "tools/report/study_figures.h"

namespace flexarm {
namespace {

constexpr std::array kKinds = {BenchmarkKind::kCommands, BenchmarkKind::kMoves,
                               BenchmarkKind::kLimits};
constexpr const char* kExperiments = FLEXARM_SOURCE_DIR "/config/experiments";

const Config& Rig() {
  static const Config rig = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml");
  return rig;
}

SweepPlan Plan(const std::string& laws, const std::string& seeds,
               BenchmarkKind kind = BenchmarkKind::kCommands) {
  return BenchmarkPlan(Rig(), BenchmarkSetOf(kind, Rig(), kExperiments), laws, seeds);
}

BenchmarkTable Table(const SweepPlan& plan, const std::vector<SweepRow>& rows,
                     BenchmarkKind kind = BenchmarkKind::kCommands) {
  return TableOf(kind, plan, rows);
}

SweepRow Made(std::size_t point, double settling_s) {
  SweepRow row{.point = point, .completed = true, .trip = {}, .refused = {}, .ticks = 801};
  row.measure.fill(1.0);
  row.measure[kSettling] = settling_s;
  return row;
}

TEST(BenchmarkPlan, RunsEveryLawInEveryScenarioWithEverySeed) {
  for (const BenchmarkKind kind : kKinds) {
    const std::size_t laws = BenchmarkSetOf(kind, Rig(), kExperiments).laws.size();
    const SweepPlan plan = Plan("", "1..3", kind);
    EXPECT_EQ(plan.grid.size(), laws * plan.scenarios.size() * 3) << Name(kind);
    std::set<std::string> names;
    for (const Scenario& scenario : plan.scenarios) names.insert(scenario.name);
    EXPECT_EQ(names.size(), plan.scenarios.size()) << Name(kind);
    EXPECT_EQ(BenchmarkKindNamed(Name(kind)), kind);
  }
  EXPECT_THROW(BenchmarkKindNamed("pictures"), InputError);
}

TEST(BenchmarkPlan, ComparesTheLawsThatFindThePayloadOnMovesWithAllTheOthers) {
  const auto laws = [](BenchmarkKind kind) {
    const auto names = BenchmarkSetOf(kind, Rig(), kExperiments).laws;
    return std::set<std::string>(names.begin(), names.end());
  };
  std::set<std::string> all = laws(BenchmarkKind::kCommands);
  EXPECT_FALSE(all.contains("gain-scheduled"));
  all.merge(laws(BenchmarkKind::kLimits));
  EXPECT_TRUE(all.contains("gain-scheduled"));
  EXPECT_TRUE(all.contains("receding-horizon"));
  EXPECT_EQ(laws(BenchmarkKind::kMoves), all);
}

// Each scenario is another run than the nominal one, and what differs is where it says.
TEST(BenchmarkPlan, EveryScenarioIsAnotherSituation) {
  for (const BenchmarkKind kind : kKinds) {
    const SweepPlan plan = Plan("sobel", "4001", kind);
    const SweepRow nominal = RunPoint(plan, 0);
    EXPECT_TRUE(nominal.completed);
    for (std::size_t point = 1; point < plan.grid.size(); ++point) {
      SweepRow row = RunPoint(plan, point);
      row.point = 0;
      EXPECT_FALSE(SameOutcome(row, nominal)) << plan.scenarios[point].name;
      EXPECT_GT(row.ticks, 0) << plan.scenarios[point].name << ": " << row.refused;
    }
  }
}

// "Same moves, same noise": what a seed draws depends on nothing else.
TEST(BenchmarkPlan, EveryLawHasTheSameMovesPayloadAndNoise) {
  const SweepPlan plan = Plan("sobel,gain-scheduled", "4001..4002", BenchmarkKind::kMoves);
  const std::size_t of_law = plan.scenarios.size() * 2;
  for (std::size_t point = 0; point < of_law; ++point) {
    const SimulationRequest a = RequestAt(plan, point), b = RequestAt(plan, point + of_law);
    EXPECT_EQ(a.payload_kg, b.payload_kg);
    EXPECT_EQ(a.config.sim.seed, b.config.sim.seed);
    ASSERT_EQ(a.experiment.move.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(a.experiment.move[i].to_deg, b.experiment.move[i].to_deg);
      EXPECT_EQ(a.experiment.move[i].duration_s, b.experiment.move[i].duration_s);
    }
    EXPECT_EQ(a.config.controller.kind, ControllerKind::kSobel);
    EXPECT_EQ(b.config.controller.kind, ControllerKind::kGainScheduled);
  }
}

// Of the first two seeds of the nominal scenario, and of the light one.
TEST(BenchmarkPlan, ASeedDrawsTheMovesAndThePayload) {
  const SweepPlan plan = Plan("sobel", "4001..4002", BenchmarkKind::kMoves);
  const SimulationRequest first = RequestAt(plan, 0), second = RequestAt(plan, 1);
  EXPECT_NE(first.payload_kg, second.payload_kg);
  EXPECT_NE(first.experiment.move[0].to_deg, second.experiment.move[0].to_deg);
  const SimulationRequest light = RequestAt(plan, 2);
  ASSERT_EQ(plan.scenarios[1].name, "light");
  EXPECT_NEAR(light.payload_kg.value(), 0.2 * first.payload_kg.value(), 1e-12);
  EXPECT_EQ(light.experiment.move[0].to_deg, first.experiment.move[0].to_deg);
}

// A count of a finer encoder is told to the controller; friction that is gone is not.
TEST(BenchmarkPlan, TheControllerKnowsItsSensorsAndNotThePlant) {
  const SweepPlan plan = Plan("gain-scheduled", "4001", BenchmarkKind::kLimits);
  for (std::size_t point = 0; point < plan.grid.size(); ++point) {
    const SimulationRequest request = RequestAt(plan, point);
    const Config& plant = request.plant ? *request.plant : request.config;
    const std::string& name = plan.scenarios[point].name;
    EXPECT_EQ(request.config.arm.joint[0].coulomb_friction_nm, 0.16) << name;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(plant.sensors.encoder[i].counts_per_turn,
                request.config.sensors.encoder[i].counts_per_turn)
          << name;
    }
    if (name == "theta1-x10") {
      EXPECT_EQ(plant.sensors.encoder[0].counts_per_turn, 25400.0);
      EXPECT_EQ(plant.sensors.encoder[1].counts_per_turn, 2540.0);
    } else if (name == "all") {
      EXPECT_EQ(plant.sensors.encoder[1].counts_per_turn, 25400.0);
      EXPECT_EQ(plant.arm.joint[0].coulomb_friction_nm, 0.0);
      EXPECT_EQ(plant.sensors.strain_input.noise_counts, 0.0);
    }
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
  const BenchmarkTable table = Table(plan, rows);
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
  const auto json = BenchmarkJson(Table(Plan("sobel", "1..2"), rows));
  const auto& nominal = json["laws"][0]["scenarios"]["nominal"];
  EXPECT_EQ(nominal["trips"], nlohmann::ordered_json({"strain-limit"}));
  EXPECT_EQ(nominal["refused"], nlohmann::ordered_json({"no such design"}));
}

TEST(BenchmarkPage, SaysNeverAndHowManyCompleted) {
  const SweepPlan plan = Plan("sobel", "1..2");
  std::vector<SweepRow> rows = {Made(0, std::nan("")), Made(1, std::nan(""))};
  rows[1].completed = false;
  const std::string page = BenchmarkMarkdown(Table(plan, rows));
  EXPECT_NE(page.find("never (1/2)"), std::string::npos) << page;
}

// Five runs: at once, late, never, one that tripped, and one at the limit.
std::vector<SweepRow> FiveRuns() {
  std::vector<SweepRow> rows = {Made(0, 0.0), Made(1, 0.32), Made(2, std::nan("")), Made(3, 0.0),
                                Made(4, 0.3)};
  rows[0].measure[kResidual] = 2.0;
  rows[0].measure[kMotion] = 5.0;
  rows[1].measure[kRms1] = 3.0;
  rows[2].measure[kRms2] = 9.0;
  rows[3].completed = false;
  rows[3].trip = "bending-strain-1";
  rows[3].measure.fill(1000.0);
  return rows;
}

TEST(RestFigures, AreOverTheCompletedRuns) {
  const RestFigures figures = RestFiguresOf(FiveRuns());
  EXPECT_EQ(figures.settled_in_time, 2U);
  EXPECT_EQ(figures.latest_settling_s, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(figures.residual_mean_mm, 5.0 / 4.0, 1e-12);
  EXPECT_EQ(figures.residual_max_mm, 2.0);
  EXPECT_NEAR(figures.motion_mean_mm, 8.0 / 4.0, 1e-12);
  EXPECT_EQ(figures.motion_max_mm, 5.0);
  EXPECT_NEAR(figures.rms_mean_deg[0], 6.0 / 4.0, 1e-12);
  EXPECT_NEAR(figures.rms_mean_deg[1], 12.0 / 4.0, 1e-12);
}

TEST(RestFigures, OfNoCompletedRunAreNone) {
  SweepRow refused = Made(0, 0.0);
  refused.completed = false;
  const RestFigures figures = RestFiguresOf({refused});
  EXPECT_EQ(figures.settled_in_time, 0U);
  EXPECT_TRUE(std::isnan(figures.latest_settling_s));
  EXPECT_TRUE(std::isnan(figures.residual_mean_mm));
}

TEST(BenchmarkJson, HasTheFiguresOfTheRests) {
  const SweepPlan plan = Plan("sobel", "1..5", BenchmarkKind::kMoves);
  const auto json = BenchmarkJson(Table(plan, FiveRuns(), BenchmarkKind::kMoves));
  EXPECT_EQ(json["table"], "moves");
  const auto& nominal = json["laws"][0]["scenarios"]["nominal"];
  EXPECT_EQ(nominal["runs"], 5);
  EXPECT_EQ(nominal["completed"], 4);
  EXPECT_EQ(nominal["settled_in_time"], 2);
  EXPECT_TRUE(nominal["latest_settling_s"].is_null());
  EXPECT_EQ(nominal["residual_max_mm"], 2.0);
  EXPECT_EQ(nominal["motion_mean_mm"], 2.0);
  EXPECT_EQ(nominal["rms_mean_deg"], nlohmann::ordered_json({1.5, 3.0}));
}

// The rests of random moves last 1.5 s: settling at once and after 0.3 and 0.32 s.
TEST(BenchmarkPage, OfTheMovesCountsWhatSettledInTime) {
  const SweepPlan plan = Plan("sobel", "1..5", BenchmarkKind::kMoves);
  const BenchmarkTable table = Table(plan, FiveRuns(), BenchmarkKind::kMoves);
  EXPECT_NEAR(table.cell[0][0].score, 100.0 * (1.0 + 1.18 / 1.5 + 1.2 / 1.5) / 5.0, 1e-12);
  const std::string page = BenchmarkMarkdown(table);
  EXPECT_NE(page.find("| nominal | 0 to 1 kg | 2/5, 1.2 (4/5) |"), std::string::npos) << page;
  EXPECT_NE(page.find("| 2/5 | never | 1.2 2.0 | 2.0 5.0 | 1.50 3.00 |"), std::string::npos)
      << page;
}

TEST(BenchmarkPage, SaysRefusedWhereNoRunWasMade) {
  const SweepPlan plan = Plan("sobel", "1", BenchmarkKind::kMoves);
  const std::string page =
      BenchmarkMarkdown(Table(plan, {RefusedRow(0, "a move is too short")}, BenchmarkKind::kMoves));
  EXPECT_NE(page.find("| nominal | 0 to 1 kg | refused |"), std::string::npos) << page;
}

// The study: nominal 100 %, motion 1.1 mm, rms 0.89 2.14 deg, of which 20 % more still count.
TEST(StudyComparison, SaysWhatIsReachedAndWhatIsNot) {
  const SweepPlan plan = Plan("gain-scheduled,sobel", "1..5", BenchmarkKind::kMoves);
  BenchmarkTable table = Table(plan, {}, BenchmarkKind::kMoves);
  BenchmarkCell& cell = table.cell[0][0];
  cell.group.runs = 5;
  cell.rests = {.settled_in_time = 5, .motion_mean_mm = 1.31, .rms_mean_deg = {1.0, 2.5}};
  table.cell[1][0] = cell;  // of a law that the study did not make
  const auto verdict = [&table] {
    const TextTable text = StudyComparison(table);
    EXPECT_EQ(text.rows.size(), 1U) << "scenarios without runs have no row";
    EXPECT_EQ(text.rows.at(0).at(1), "gain-scheduled");
    return text.rows.at(0).back().substr(0, 11);
  };
  EXPECT_EQ(verdict(), "reached");
  cell.rests.motion_mean_mm = 1.33;
  EXPECT_EQ(verdict(), "not reached");
  cell.rests.motion_mean_mm = 1.31;
  cell.rests.rms_mean_deg[1] = 2.6;
  EXPECT_EQ(verdict(), "not reached");
  cell.rests.rms_mean_deg[1] = 2.5;
  cell.rests.settled_in_time = 4;
  EXPECT_EQ(verdict(), "not reached");
}

}  // namespace
}  // namespace flexarm
