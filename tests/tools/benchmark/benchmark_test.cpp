#include "tools/benchmark/benchmark.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "controller/runlog/errors.h"
#include "tests/support/message_of.h"
#include "tests/tools/benchmark/benchmark_rows.h"
#include "tools/report/study_figures.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

constexpr std::array kKinds = {BenchmarkKind::kCommands, BenchmarkKind::kMoves,
                               BenchmarkKind::kLimits, BenchmarkKind::kFast};

TEST(BenchmarkPlan, RunsEveryLawInEveryScenarioWithEverySeed) {
  for (const BenchmarkKind kind : kKinds) {
    const std::size_t laws = BenchmarkSetOf(kind, Rig(), kExperiments).laws.size();
    const SweepPlan plan = Plan("", "1..3", kind);
    EXPECT_EQ(plan.grid.size(), laws * plan.scenarios.size() * 3) << ToString(kind);
    std::set<std::string> names;
    for (const Scenario& scenario : plan.scenarios) names.insert(scenario.name);
    EXPECT_EQ(names.size(), plan.scenarios.size()) << ToString(kind);
    EXPECT_EQ(BenchmarkKindNamed(ToString(kind)), kind);
  }
  EXPECT_THAT(MessageOf<InputError>([] { BenchmarkKindNamed("pictures"); }),
              HasSubstr("expected one of commands, moves, limits, fast"));
}

TEST(BenchmarkPlan, AnUnknownLawIsRefusedBeforeARunIsMade) {
  EXPECT_THROW(Plan("pid", "1"), ConfigError);
}

TEST(BenchmarkPlan, UsesTheLawsAndSeedsOfTheSetByDefault) {
  const SweepPlan commands = Plan("", ""), moves = Plan("", "", BenchmarkKind::kMoves);
  EXPECT_EQ(commands.grid.axes()[0].values, CommandLaws());
  EXPECT_EQ(commands.grid.axes()[2].values, (std::vector<std::string>{"1", "2", "3"}));
  EXPECT_EQ(commands.experiment.name, "benchmark-square")
      << "the experiment of the nominal scenario";
  EXPECT_EQ(moves.grid.axes()[2].values.front(), "4001");
  EXPECT_EQ(moves.grid.axes()[2].values.size(), 10U);
}

TEST(BenchmarkSet, OfSelectedScenariosHasOnlyThose) {
  const BenchmarkSet set = Only(BenchmarkSetOf(BenchmarkKind::kMoves, Rig(), kExperiments),
                                {"viscous", "nominal", "no such"});
  ASSERT_EQ(set.scenarios.size(), 2U);
  EXPECT_EQ(set.scenarios[0].name, "nominal");
  EXPECT_EQ(set.scenarios[1].name, "viscous");
}

TEST(BenchmarkSet, OfTheLimitsRemovesThemOneByOneAndAllAtTheEnd) {
  const auto limits = BenchmarkSetOf(BenchmarkKind::kLimits, Rig(), kExperiments).scenarios;
  EXPECT_EQ(limits.front().name, "nominal");
  EXPECT_EQ(limits.back().name, "all");
}

TEST(BenchmarkPlan, ComparesTheLawsThatEstimateThePayloadOnMovesWithAllOthers) {
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

// Each scenario differs from the nominal one, and only in the part that it names.
TEST(BenchmarkPlan, EveryScenarioDiffersFromTheNominalOne) {
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

// "Same moves, same noise": the seed alone determines them.
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

// For the first two seeds of the nominal scenario and of the light one.
TEST(BenchmarkPlan, TheSeedDeterminesTheMovesAndThePayload) {
  const SweepPlan plan = Plan("sobel", "4001..4002", BenchmarkKind::kMoves);
  const SimulationRequest first = RequestAt(plan, 0), second = RequestAt(plan, 1);
  EXPECT_NE(first.payload_kg, second.payload_kg);
  EXPECT_NE(first.experiment.move[0].to_deg, second.experiment.move[0].to_deg);
  const SimulationRequest light = RequestAt(plan, 2);
  ASSERT_EQ(plan.scenarios[1].name, "light");
  EXPECT_NEAR(light.payload_kg.value(), 0.2 * first.payload_kg.value(), 1e-12);
  EXPECT_EQ(light.experiment.move[0].to_deg, first.experiment.move[0].to_deg);
}

// The controller knows the size of a count of a finer encoder; it does not know that friction is
// removed.
TEST(BenchmarkPlan, TheControllerKnowsItsSensorsAndNotThePlant) {
  const SweepPlan plan = Plan("gain-scheduled", "4001", BenchmarkKind::kLimits);
  for (std::size_t point = 0; point < plan.grid.size(); ++point) {
    const SimulationRequest request = RequestAt(plan, point);
    const RigConfig& plant = request.plant ? *request.plant : request.config;
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

SimulationRequest RequestOf(const SweepPlan& plan, const std::string& name) {
  for (std::size_t point = 0; point < plan.scenarios.size(); ++point) {
    if (plan.scenarios[point].name == name) return RequestAt(plan, point);
  }
  throw InputError("no scenario " + name);
}

// The simulated rig of a scenario.
RigConfig PlantOf(const SweepPlan& plan, const std::string& name) {
  const SimulationRequest request = RequestOf(plan, name);
  return request.plant ? *request.plant : request.config;
}

// Also fails if a name stands for another plant than it says.
TEST(BenchmarkPlan, AScenarioIsWhatItsNameSays) {
  const SweepPlan plan = Plan("sobel", "1");
  const RigConfig& rig = Rig();
  for (const char* payload : {"0", "0.01", "0.05", "0.15", "0.2", "0.5", "1"}) {
    EXPECT_EQ(RequestOf(plan, std::string("payload-") + payload).payload_kg, std::stod(payload));
  }
  EXPECT_EQ(RequestOf(plan, "sine").experiment.name, "benchmark-sine");
  EXPECT_EQ(RequestOf(plan, "waypoints-0.5").experiment.name, "benchmark-waypoints");
  EXPECT_EQ(RequestOf(plan, "unseen").experiment.name, "benchmark-unseen");
  EXPECT_EQ(PlantOf(plan, "noise-x3").sensors.strain_input.noise_counts,
            3.0 * rig.sensors.strain_input.noise_counts);
  EXPECT_EQ(PlantOf(plan, "lost-frames").sim.lost_frame_fraction, 0.1);
  for (std::size_t i = 0; i < 2; ++i) {
    const JointParameters& joint = rig.arm.joint[i];
    EXPECT_NEAR(PlantOf(plan, "soft-joints").arm.joint[i].stiffness_nm_per_rad,
                0.7 * joint.stiffness_nm_per_rad, 1e-9);
    EXPECT_NEAR(PlantOf(plan, "soft-links").arm.link[i].section[0].youngs_modulus_pa,
                0.9 * rig.arm.link[i].section[0].youngs_modulus_pa, 1.0);
    EXPECT_NEAR(PlantOf(plan, "friction-x3").arm.joint[i].coulomb_friction_nm,
                3.0 * joint.coulomb_friction_nm, 1e-12);
  }
  EXPECT_NEAR(PlantOf(plan, "backlash").arm.joint2_backlash.clearance_rad, M_PI / 180.0, 1e-6);
  for (const char* late : {"delay-2", "delay-2-unknown"}) {
    EXPECT_EQ(PlantOf(plan, late).sim.transport_delay_ms, 20.0) << late;
  }
  EXPECT_EQ(RequestOf(plan, "delay-2").config.loop.actuation_delay_ms, 20.0);
  EXPECT_EQ(RequestOf(plan, "delay-2-unknown").config.loop.actuation_delay_ms, 0.0);
}

TEST(BenchmarkPlan, AScenarioOfTheMovesIsWhatItsNameSaysOnTheWiderRig) {
  const SweepPlan moves = Plan("gain-scheduled", "4001", BenchmarkKind::kMoves);
  const SweepPlan limits = Plan("gain-scheduled", "4001", BenchmarkKind::kLimits);
  for (const Scenario& scenario : moves.scenarios) {
    EXPECT_EQ(PlantOf(moves, scenario.name).sim.switch_angle_deg[1], 115.0) << scenario.name;
  }
  const auto& viscous = PlantOf(moves, "viscous").arm.joint;
  EXPECT_EQ(viscous[0].viscous_friction_nm_s_per_rad, 0.05);
  EXPECT_EQ(viscous[1].viscous_friction_nm_s_per_rad, 0.02);
  EXPECT_NEAR(PlantOf(moves, "backlash-0.2").arm.joint2_backlash.clearance_rad, 0.2 * M_PI / 180.0,
              1e-6);
  EXPECT_EQ(PlantOf(moves, "modal-damping-1").arm.link[1].damping_ratio, 0.01);
  for (const SweepPlan* plan : {&moves, &limits}) {
    for (const JointParameters& joint : PlantOf(*plan, "no-friction").arm.joint) {
      EXPECT_EQ(joint.coulomb_friction_nm, 0.0);
    }
  }
  for (const char* quiet : {"quiet-gauges", "encoders-quiet", "all"}) {
    EXPECT_EQ(PlantOf(limits, quiet).sensors.strain_input.noise_counts, 0.0) << quiet;
  }
  for (const char* finer : {"encoders-x10", "encoders-quiet", "no-friction-encoders", "all"}) {
    EXPECT_EQ(PlantOf(limits, finer).sensors.encoder[1].counts_per_turn, 25400.0) << finer;
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

// The rests of benchmark-square last 7 s: settling in 1.4 s gives 80 %; a trip or a tip that never
// settles gives 0.
TEST(BenchmarkTable, TheScoreIsTheShareOfTheRestAfterSettling) {
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
  // The other scenarios have no run and count 0.
  EXPECT_NEAR(table.Score(0), cell.score / static_cast<double>(plan.scenarios.size()), 1e-12);
  EXPECT_NE(table.WorstScenario(0), 0U);
}

// A score is never negative: the shortest rest of benchmark-waypoints lasts 6.4 s, and the settling
// time of a longer rest may exceed it.
TEST(BenchmarkTable, ASettlingTimeBeyondTheShortestRestScoresZero) {
  const SweepPlan plan = Plan("sobel", "1..2");
  const BenchmarkTable table = Table(plan, {Made(0, 7.7), Made(1, 0.0)});
  EXPECT_NEAR(table.cell[0][0].score, (0.0 + 100.0) / 2.0, 1e-12);
}

TEST(BenchmarkJson, HasEveryRunUnderItsLawAndScenario) {
  const SweepPlan plan = Plan("sobel,pd", "1");
  const std::size_t scenarios = plan.scenarios.size();
  ASSERT_EQ(plan.scenarios[9].name, "waypoints");
  const auto json = BenchmarkJson(Table(plan, OneEach(plan)));
  ASSERT_EQ(json["laws"].size(), 2U);
  const auto &sobel = json["laws"][0], &pd = json["laws"][1];
  EXPECT_EQ(sobel["name"], "sobel");
  EXPECT_EQ(sobel["runs"], scenarios);
  EXPECT_EQ(sobel["completed"], scenarios - 1);
  EXPECT_EQ(sobel["worst_scenario"], plan.scenarios[3].name);
  EXPECT_EQ(sobel["worst_score"], 0.0);
  EXPECT_EQ(sobel["scenarios"]["nominal"]["score"], 90.0);
  EXPECT_EQ(pd["completed"], scenarios);
  EXPECT_EQ(pd["worst_scenario"], "waypoints");
  EXPECT_NEAR(pd["worst_score"].get<double>(), 25.0, 1e-12);
  EXPECT_NEAR(pd["scenarios"]["waypoints"]["score"].get<double>(), 25.0, 1e-12);
  EXPECT_NEAR(pd["scenarios"]["nominal"]["score"].get<double>(), 80.0, 1e-12);
  double sum = 0.0;
  for (const auto& scenario : pd["scenarios"]) sum += scenario["score"].get<double>();
  EXPECT_NEAR(pd["score"].get<double>(), sum / static_cast<double>(scenarios), 1e-12);
}

TEST(BenchmarkJson, DistinguishesTripsFromRefusals) {
  std::vector<SweepRow> rows = {Made(0, 1.4), Made(1, 1.4)};
  rows[0].completed = rows[1].completed = false;
  rows[0].trip = "strain-limit";
  rows[1].refused = "no such design";
  const auto json = BenchmarkJson(Table(Plan("sobel", "1..2"), rows));
  const auto& nominal = json["laws"][0]["scenarios"]["nominal"];
  EXPECT_EQ(nominal["trips"], nlohmann::ordered_json({"strain-limit"}));
  EXPECT_EQ(nominal["refused"], nlohmann::ordered_json({"no such design"}));
}

TEST(RestFigures, AreOverTheCompletedRuns) {
  const RestFigures figures = RestFiguresOf(FiveRuns());
  EXPECT_EQ(figures.settled_in_time, 2U);
  EXPECT_EQ(figures.latest_settling_s, std::numeric_limits<double>::infinity());
  EXPECT_EQ(figures.target_error_max_mm, 7.0);
  EXPECT_NEAR(figures.residual_mean_mm, 5.0 / 4.0, 1e-12);
  EXPECT_EQ(figures.residual_max_mm, 2.0);
  EXPECT_NEAR(figures.motion_mean_mm, 8.0 / 4.0, 1e-12);
  EXPECT_EQ(figures.motion_max_mm, 5.0);
  EXPECT_NEAR(figures.rms_mean_deg[0], 6.0 / 4.0, 1e-12);
  EXPECT_NEAR(figures.rms_mean_deg[1], 12.0 / 4.0, 1e-12);
}

TEST(RestFigures, HaveTheLongestOfAllSettlingTimes) {
  EXPECT_EQ(RestFiguresOf({Made(0, 0.1), Made(1, 0.5), Made(2, 0.0)}).latest_settling_s, 0.5);
}

TEST(RestFigures, WithoutACompletedRunAreNaN) {
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
  EXPECT_EQ(nominal["target_error_max_mm"], 7.0);
  EXPECT_EQ(nominal["residual_mean_mm"], 1.25);
  EXPECT_EQ(nominal["residual_max_mm"], 2.0);
  EXPECT_EQ(nominal["motion_mean_mm"], 2.0);
  EXPECT_EQ(nominal["motion_max_mm"], 5.0);
  EXPECT_EQ(nominal["rms_mean_deg"], nlohmann::ordered_json({1.5, 3.0}));
}

// The design study: nominal 100 %, motion 1.1 mm, rms 0.89 2.14 deg; up to 20 % more counts as
// reached.
TEST(StudyComparison, MarksRowsAsReachedOrNotReached) {
  const SweepPlan plan = Plan("gain-scheduled,sobel", "1..5", BenchmarkKind::kMoves);
  BenchmarkTable table = Table(plan, {}, BenchmarkKind::kMoves);
  BenchmarkCell& cell = table.cell[0][0];
  cell.group.runs = 5;
  cell.rests = {.settled_in_time = 5, .motion_mean_mm = 1.31, .rms_mean_deg = {1.0, 2.5}};
  table.cell[1][0] = cell;  // of a law that the design study does not have
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
