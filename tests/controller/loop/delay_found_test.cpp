// An undeclared delay of whole samples, estimated by `ekf-payload` and compensated from then on;
// and none is found where there is none. All figures: docs/timing.md.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "controller/realtime/float_environment.h"
#include "controller/runlog/metrics.h"
#include "model/rigid_joint/rigid_joint_arm.h"
#include "tests/controller/loop/stack_run.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

constexpr int kDelayRuns = 40;

// An undeclared delay is beyond what the loop is designed for: of 560 other runs (both laws, one
// and two samples more) 4 % had not settled in time after the first move, and 1 to 2 % tripped. The
// bounds are the most of these 40 runs of any row below, and one run more. One choice that is
// reversed costs two changes.
constexpr int kLate = 4, kMissed = 1, kReversed = 2;

// How the plant's delay differs from the declared one.
struct Undeclared {
  const char* name;
  int samples;  // by which torques act later than is declared
  std::vector<std::string> config;
};

// The simulated transport has the delay that is not declared to the loop.
const Undeclared kMore{"OneMore", 1, {"sim.transport_delay_ms=20"}};
const Undeclared kLess{"OneLess", -1, {"loop.actuation_delay_ms=20"}};
const Undeclared kTwoMore{"TwoMore", 2, {"sim.transport_delay_ms=40"}};

RigConfig RigWith(const std::vector<std::string>& overrides, const std::string& law,
                  bool detect = true) {
  std::vector<std::string> all = kWideRig;
  all.insert(all.end(), {"controller.name=" + law, std::string("estimator.payload.detect_delay=") +
                                                       (detect ? "true" : "false")});
  all.insert(all.end(), overrides.begin(), overrides.end());
  return ShippedRig(all);
}

bool IsRunning(const TickRecord& record) {
  return record.input.safety_state == SafetyState::kRunning;
}

// The rest after a move, by RunMetrics of an experiment with that move alone.
double Settling_s(const StackRun& run, const Experiment& experiment, std::size_t move) {
  Experiment one = experiment;
  one.move = {experiment.move[move]};
  if (move + 1 < experiment.move.size()) one.duration_s = experiment.move[move + 1].start_s;
  const RunMetrics metrics =
      ComputeMetrics(run.tick, one, run.grid().period_s(), TipGeometryOf(run.config()));
  return metrics.tip_settling_time_s.value_or(std::numeric_limits<double>::infinity());
}

struct DelayOutcome {
  bool tripped;
  int found;           // at the end of the experiment
  int changes;         // of the delay found
  double found_s;      // when it was found last, after the start of the experiment
  double first_end_s;  // of the first move
  double first_settling_s, later_settling_s;
};

DelayOutcome RunOf(const Undeclared& rig, const std::string& law, std::uint64_t seed, bool detect) {
  RigConfig config = RigWith(rig.config, law, detect);
  config.sim.seed = seed;
  const RandomMoves moves = MakeRandomMoves(RigidJointArm(config.arm), seed, 1.0);
  StackRun run(config, moves.experiment, moves.payload_kg);
  run.Run(std::llround(1e9 * (moves.experiment.duration_s + 2.0)));
  const Experiment& experiment = moves.experiment;
  DelayOutcome out{};
  out.tripped = run.safety.back().after.state == SafetyState::kTripped;
  out.first_end_s = *experiment.move[0].duration_s;
  const auto first = std::find_if(run.tick.begin(), run.tick.end(), IsRunning);
  for (auto tick = first; tick != run.tick.end() && IsRunning(*tick); ++tick) {
    if (tick->output.delay_found == out.found) continue;
    out.found = tick->output.delay_found;
    ++out.changes;
    out.found_s = 1e-9 * static_cast<double>(tick->input.sampling_instant_ns -
                                             first->input.sampling_instant_ns);
  }
  out.first_settling_s = Settling_s(run, experiment, 0);
  for (std::size_t move = 1; move < experiment.move.size(); ++move) {
    out.later_settling_s = std::max(out.later_settling_s, Settling_s(run, experiment, move));
  }
  return out;
}

// Counts over all runs, and the extreme instants.
struct Summary {
  int found = 0, found_in_first = 0, changes = 0, tripped = 0, settled = 0, settled_later = 0;
  double earliest_s = std::numeric_limits<double>::infinity(), found_s = 0.0;
  double first_settling_s = 0.0, later_settling_s = 0.0;
};

Summary RunAll(const Undeclared& rig, const std::string& law, bool detect) {
  Summary all;
  for (int i = 0; i < kDelayRuns; ++i) {
    const std::uint64_t seed = 4001 + static_cast<std::uint64_t>(i);
    const DelayOutcome run = RunOf(rig, law, seed, detect);
    const bool found = run.found == rig.samples;
    all.found += found ? 1 : 0;
    all.found_in_first += found && run.found_s < run.first_end_s ? 1 : 0;
    all.changes += run.changes;
    all.tripped += run.tripped ? 1 : 0;
    all.settled += run.first_settling_s <= 0.3 ? 1 : 0;
    all.settled_later += run.later_settling_s <= 0.3 ? 1 : 0;
    if (found) all.earliest_s = std::min(all.earliest_s, run.found_s);
    all.found_s = std::max(all.found_s, found ? run.found_s : 0.0);
    all.first_settling_s = std::max(all.first_settling_s, run.first_settling_s);
    all.later_settling_s = std::max(all.later_settling_s, run.later_settling_s);
  }
  std::printf(
      "  %s, %s, %s: found in %d of %d runs, %d in the first move, after %.2f to %.2f s; %d trips; "
      "settled in time after the first move %d, latest %.2f s, after the later ones %d, %.2f s\n",
      law.c_str(), rig.name, detect ? "looked for" : "not looked for", all.found, kDelayRuns,
      all.found_in_first, all.earliest_s, all.found_s, all.tripped, all.settled,
      all.first_settling_s, all.settled_later, all.later_settling_s);
  return all;
}

using LawAndDelay = std::tuple<std::string, Undeclared>;

class UndeclaredDelay : public testing::TestWithParam<LawAndDelay> {};

TEST_P(UndeclaredDelay, IsFoundAndTheLaterMovesSettleInTime) {
  const auto& [law, rig] = GetParam();
  const Summary all = RunAll(rig, law, true), blind = RunAll(rig, law, false);
  EXPECT_EQ(all.found, kDelayRuns);
  // Torques that act earlier do little harm, and have little effect on the innovations.
  EXPECT_GE(all.found_in_first, rig.samples > 0 ? kDelayRuns - kMissed : 4 * kDelayRuns / 5);
  EXPECT_LE(all.changes, kDelayRuns + kReversed) << "one per run, hardly one is reversed";
  EXPECT_LE(all.tripped, 1 + kMissed);
  EXPECT_GE(all.settled, kDelayRuns - kLate);
  EXPECT_GE(all.settled_later, kDelayRuns - 1 - kMissed);
  EXPECT_EQ(blind.changes, 0);
  if (rig.samples > 0) {
    EXPECT_LT(blind.settled_later, kDelayRuns)
        << "this delay does no harm: the test is inconclusive";
  }
}

INSTANTIATE_TEST_SUITE_P(LawsAndDelays, UndeclaredDelay,
                         testing::Combine(testing::Values("gain-scheduled", "receding-horizon"),
                                          testing::Values(kMore, kLess, kTwoMore)),
                         [](const auto& of) {
                           return (std::get<0>(of.param) == "gain-scheduled" ? "GainScheduled"
                                                                             : "RecedingHorizon") +
                                  std::string(std::get<1>(of.param).name);
                         });

// A minute of rest with noise at the last set-point, with and without backlash.
TEST(UnknownDelay, IsNotFoundAtRest) {
  Experiment rest = ShippedExperiment("benchmark-waypoints");
  rest.move = {{.start_s = 60.0, .duration_s = 2.0, .to_deg = {0.0, 0.1}}};
  rest.duration_s = 63.0;
  for (const std::vector<std::string>& plant :
       {std::vector<std::string>{"loop.actuation_delay_ms=20", "sim.transport_delay_ms=20"},
        std::vector<std::string>{"joint2.backlash_rad=0.0174533",
                                 "joint2.backlash_model=dead_zone"}}) {
    StackRun run(RigWith(plant, "gain-scheduled"), rest);
    run.Run(66'000'000'000);
    int running = 0;
    for (const TickRecord& record : run.tick) {
      running += IsRunning(record) ? 1 : 0;
      ASSERT_EQ(record.output.delay_found, 0) << record.input.tick;
    }
    EXPECT_EQ(running, 63 * 50);
  }
}

// Number of samples by which a plan advances between two steps, by its own rates.
double SamplesOn(const MotionSample& before, const MotionSample& now) {
  using Joints = Eigen::Matrix<double, 6, 1>;
  const Joints by = Joints::Map(now.x.data()) - Joints::Map(before.x.data());
  const Joints rate = 0.5 * (Joints::Map(now.x.data() + 6) + Joints::Map(before.x.data() + 6));
  return by.dot(rate) / (0.02 * rate.squaredNorm());
}

class DelayFound : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Laws, DelayFound, testing::Values("gain-scheduled", "receding-horizon"),
                         [](const auto& law) {
                           return law.param == "gain-scheduled" ? "GainScheduled"
                                                                : "RecedingHorizon";
                         });

// Once the delay is found, the reference and the plan are read one sample later, and the record
// replays bit by bit. The payload is the initial value of the estimator: with a heavy one the plan
// after the change differs from the one before, and the comparison is inconclusive; so it is with
// seed 1 of 1 to 6, where the estimate changes just before.
TEST_P(DelayFound, MovesTheReferenceAndReplays) {
  RigConfig config = RigWith(kMore.config, GetParam());
  config.sim.seed = 2;
  StackRun run(config, ShippedExperiment("benchmark-waypoints"), 0.2);
  run.Run(9'000'000'000);
  ControlStep fresh(run.config(), run.design());
  const FlushDenormals as_in_the_tasks;
  std::size_t found_at = 0;
  int apart = 0;
  for (std::size_t k = 0; k < run.tick.size(); ++k) {
    const TickRecord& record = run.tick[k];
    const StepOutput output = fresh.Step(record.input);
    ASSERT_EQ(std::memcmp(&output, &record.output, sizeof(output)), 0) << record.input.tick;
    if (found_at == 0 && record.output.delay_found == 1) found_at = k;
    if (k == 0 || !IsRunning(record) || !IsRunning(run.tick[k - 1])) continue;
    // From one sample to the next the path advances by one sample; once by two.
    const StepInput &before = run.tick[k - 1].input, &now = record.input;
    if (std::memcmp(&now.path[0], &before.path[1], sizeof(RigidPoint)) == 0) continue;
    ++apart;
    EXPECT_EQ(k, found_at + 1);
    EXPECT_EQ(std::memcmp(&now.path[0], &before.path[2], sizeof(RigidPoint)), 0);
    EXPECT_EQ(now.acts_late_ns, before.acts_late_ns) << "the declared delay does not change";
    if (GetParam() != "receding-horizon") continue;
    EXPECT_EQ(now.planned, 1);
    EXPECT_NEAR(SamplesOn(before.plan, now.plan), 2.0, 0.2);
    EXPECT_NEAR(SamplesOn(run.tick[k - 2].input.plan, before.plan), 1.0, 0.1);
  }
  EXPECT_EQ(apart, 1);
  EXPECT_GT(found_at, 0u);
}

// The result belongs to one arming: the next begins with the declared delay.
TEST(UnknownDelay, IsResetWhenTheArmIsArmedAgain) {
  Experiment experiment = ShippedExperiment("benchmark-waypoints");
  StackRun run(RigWith(kMore.config, "gain-scheduled"), experiment, 0.3);
  run.Run(5'000'000'000);
  ASSERT_EQ(run.tick.back().output.delay_found, 1);
  ASSERT_EQ(run.Ask(RequestKind::kStop), Refusal::kNone);
  while (run.permit().state == SafetyState::kStopping) run.Run(run.now_ns() + 20'000'000, false);
  ASSERT_EQ(run.permit().state, SafetyState::kArmed);
  EXPECT_EQ(run.tick.back().output.delay_found, 1) << "a second run would keep it";
  ASSERT_EQ(run.Ask(RequestKind::kDisarm), Refusal::kNone);
  ASSERT_EQ(run.Ask(RequestKind::kArm), Refusal::kNone);
  run.Run(run.now_ns() + 100'000'000, false);
  EXPECT_EQ(run.tick.back().output.delay_found, 0);
}

}  // namespace
}  // namespace flexarm
