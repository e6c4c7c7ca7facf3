// The laws that estimate the payload, through the real sensor chain, on moves, payloads and seeds
// that were not used for tuning; and the laws of the thesis on the same moves.

#include <gtest/gtest.h>

#include <cstdio>

#include "controller/law/scheduling_payload.h"
#include "tests/controller/loop/simulated_runs.h"
#include "tests/controller/loop/stack_run.h"
#include "tools/benchmark/benchmark.h"
#include "tools/sweep/sweep_row.h"

namespace flexarm {
namespace {

constexpr int kLongSet = 24, kShortSet = 10;

// A scenario of the benchmark's table of moves with seeds that are not the benchmark's own. All
// delays are as declared: none is found.
BenchmarkCell RunMoves(const std::string& law, const std::string& scenario, int first_seed,
                       int seeds) {
  const RigConfig config = ShippedRig();
  const BenchmarkSet set = Only(BenchmarkSetOf(BenchmarkKind::kMoves, config, {}), {scenario});
  const SweepPlan plan = BenchmarkPlan(
      config, set, law, std::to_string(first_seed) + ".." + std::to_string(first_seed + seeds - 1));
  std::vector<SweepRow> rows;
  for (std::size_t point = 0; point < plan.grid.size(); ++point) {
    const SimulationRequest request = RequestAt(plan, point);
    const SimulationResult result = Simulate(request);
    EXPECT_EQ(result.delay_found, 0) << law << ' ' << scenario << ' ' << point;
    rows.push_back(RowOf(point, request, result));
  }
  const BenchmarkCell cell = TableOf(set, plan, rows).cell.at(0).at(0);
  const RestFigures& r = cell.rests;
  std::printf(
      "  %-14s %-16s %2zu of %2d settle in time, %2zu complete; rms %.2f %.2f deg, settled after "
      "%.2f s at most, residual %.1f, %.1f mm at most, motion %.1f, %.1f mm at most\n",
      law.c_str(), scenario.c_str(), r.settled_in_time, seeds, cell.group.completed,
      r.rms_mean_deg[0], r.rms_mean_deg[1], r.latest_settling_s, r.residual_mean_mm,
      r.residual_max_mm, r.motion_mean_mm, r.motion_max_mm);
  return cell;
}

class FindsThePayload : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Laws, FindsThePayload,
                         testing::Values("gain-scheduled", "receding-horizon"),
                         [](const auto& law) {
                           return law.param == "gain-scheduled" ? "GainScheduled"
                                                                : "RecedingHorizon";
                         });

// The acceptance limits.
TEST_P(FindsThePayload, TheTipIsAtRestWhenTheMoveEnds) {
  const BenchmarkCell cell = RunMoves(GetParam(), "nominal", 1001, kLongSet);
  EXPECT_EQ(cell.group.completed, 24U);
  EXPECT_GE(cell.rests.settled_in_time, 24U) << "98 % of the moves";
  EXPECT_LE(cell.rests.residual_mean_mm, 1.5);
}

// They settle in time in 4 and 2 of 24 runs (the design study: 4 % and 8 %).
TEST(TheLawsOfTheThesis, DoNotSettleInTimeOnTheSameMoves) {
  for (const char* law : {"sobel", "lqr-cgt"}) {
    EXPECT_LT(RunMoves(law, "nominal", 1001, kLongSet).rests.settled_in_time, 12U) << law;
  }
}

// Each move begins with an estimate of at least 0.5 kg (docs/theory/fast-moves.md 3), which costs
// light arms accuracy in the first tenths of a second: 0.18 and 0.35 deg without a plan, 0.22 and
// 0.47 with one; 0.26 and 0.15 for the elbow with a start at 0.2 kg, at which heavy arms trip. The
// bars are a seventh above.
TEST_P(FindsThePayload, LightPayloadsStayOnTheReference) {
  const BenchmarkCell cell = RunMoves(GetParam(), "light", 2001, kLongSet);
  EXPECT_EQ(cell.group.completed, 24U);
  EXPECT_GE(cell.rests.settled_in_time, 24U);
  EXPECT_LE(cell.rests.rms_mean_deg[0], GetParam() == "gain-scheduled" ? 0.20 : 0.25);
  EXPECT_LE(cell.rests.rms_mean_deg[1], GetParam() == "gain-scheduled" ? 0.40 : 0.54);
}

// The 15 plants of docs/theory/payload.md 6.3.
TEST_P(FindsThePayload, OnPlantsThatDifferFromTheModel) {
  std::size_t settled = 0, all = 0;
  for (const char* scenario :
       {"nominal", "backlash-0.2", "backlash", "friction-x3", "no-friction", "soft-joints",
        "soft-links", "modal-damping", "modal-damping-1", "lost-frames", "delay-0", "delay-2",
        "noise-x3", "viscous", "together"}) {
    const BenchmarkCell cell = RunMoves(GetParam(), scenario, 3001, kShortSet);
    EXPECT_EQ(cell.group.completed, cell.group.runs) << scenario;
    settled += cell.rests.settled_in_time;
    all += cell.group.runs;
  }
  EXPECT_EQ(all, 150U);
  EXPECT_GE(static_cast<double>(settled), 0.95 * static_cast<double>(all));
}

struct Warned {
  std::uint32_t warnings;  // all that the run had
  double payload_kg;       // at its end
  double sigma_kg;
};

Warned WarningsOf(double payload_kg, const Experiment& experiment,
                  std::vector<std::string> overrides = {}, std::int64_t until_ns = 10'000'000'000) {
  overrides.emplace_back("controller.name=gain-scheduled");
  StackRun run(ShippedRig(overrides), experiment, payload_kg);
  run.Run(until_ns);
  Warned out{};
  for (const TickRecord& record : run.tick) {
    if (record.input.safety_state != SafetyState::kRunning) continue;
    out.warnings |= record.output.payload_warnings;
    out.payload_kg = record.output.payload_kg;
    out.sigma_kg = record.output.payload_sigma_kg;
  }
  return out;
}

TEST(GainScheduled, APayloadWithinItsRangeIsEstimatedWithoutWarning) {
  const Warned found = WarningsOf(0.35, ShippedExperiment("benchmark-waypoints"));
  EXPECT_EQ(found.warnings, 0u);
  EXPECT_NEAR(found.payload_kg, 0.35, 0.03);
}

TEST(GainScheduled, APayloadBeyondItsRangeRaisesAWarning) {
  const Warned found =
      WarningsOf(0.35, ShippedExperiment("benchmark-waypoints"),
                 {"estimator.payload.max_kg=0.25", "estimator.payload.start_kg=0.2"});
  EXPECT_EQ(found.warnings & kPayloadAtBound, kPayloadAtBound);
  EXPECT_LE(found.payload_kg, 0.25);
}

// Less than two counts of the hubs' encoders. With half a degree the joints stick and slip, and it
// depends on the noise whether a slip is fast enough for the payload to be estimated.
TEST(GainScheduled, AnUninformativeMoveRaisesAWarning) {
  Experiment creeping = ShippedExperiment("benchmark-waypoints");
  creeping.move = {{.start_s = 0.0, .duration_s = 2.0, .to_deg = {0.25, 0.25}}};
  const Warned found = WarningsOf(0.35, creeping);
  EXPECT_EQ(found.warnings, static_cast<std::uint32_t>(kPayloadNotObservable));
}

// The random walk of the payload takes sigma past that at the start of a move; this is no fault.
TEST(GainScheduled, ALongRestRaisesNoWarning) {
  Experiment resting = ShippedExperiment("benchmark-waypoints");
  resting.duration_s = 32.0;
  resting.move = {{.start_s = 0.0, .duration_s = 1.6, .to_deg = {30, 30}}};
  const Warned found = WarningsOf(0.35, resting, {}, 35'000'000'000);
  EXPECT_EQ(found.warnings, 0u);
  EXPECT_GT(found.sigma_kg, 0.1) << "too short a rest: the test is inconclusive";
  EXPECT_NEAR(found.payload_kg, 0.35, 0.03) << "flickering counts must not change it";
}

}  // namespace
}  // namespace flexarm
