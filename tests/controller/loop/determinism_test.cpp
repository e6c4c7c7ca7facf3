// The same config and seed give the same bytes, and the recorded inputs alone give the same
// outputs.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "controller/design/design_json.h"
#include "controller/realtime/float_environment.h"
#include "tests/controller/loop/stack_run.h"

namespace flexarm {
namespace {

constexpr std::int64_t kEndNs = 9'000'000'000;  // arm 0.7 s, run 6 s, stop and disarm

std::unique_ptr<StackRun> Recorded(const std::vector<std::string>& overrides = {}) {
  auto run = std::make_unique<StackRun>(ShippedRig(overrides), ShippedExperiment());
  run->Run(kEndNs);
  return run;
}

TEST(Determinism, TheSameSeedGivesTheSameBytesAndAnotherSeedDoesNot) {
  const auto once = Recorded(), again = Recorded(), other = Recorded({"sim.seed=2"});
  // One step every 20 ms, the first due at 10 ms.
  EXPECT_EQ(once->tick.size(), 450u);
  EXPECT_TRUE(SameTicks(*once, *again));
  EXPECT_FALSE(SameTicks(*once, *other));
}

TEST(Determinism, TheRunPassesThroughEveryStateAndEndsInIdle) {
  const auto run = Recorded();
  std::vector<SafetyState> states = {run->safety.front().before.state};
  for (const SafetyRecord& record : run->safety) {
    if (record.after.state != states.back()) states.push_back(record.after.state);
  }
  using enum SafetyState;
  EXPECT_EQ(states, (std::vector{kStarting, kIdle, kArmed, kRunning, kStopping, kArmed, kDisarming,
                                 kIdle}));
  const auto running = std::count_if(run->tick.begin(), run->tick.end(), [](const TickRecord& r) {
    return r.input.safety_state == kRunning;
  });
  EXPECT_EQ(running, 300);
}

void ExpectReplays(const std::vector<std::string>& overrides) {
  const auto run = Recorded(overrides);
  ControlStep fresh(run->config(), run->design());
  const FlushDenormals as_in_the_tasks;
  for (const TickRecord& record : run->tick) {
    const StepOutput output = fresh.Step(record.input);
    ASSERT_TRUE(SameBytes(output, record.output)) << "tick " << record.input.tick;
  }
}

TEST(Determinism, RecordedInputsThroughAFreshStepGiveTheSameBytes) { ExpectReplays({}); }

// The design passes through the log's text: the filter's model is not computed again. Plans come
// from the recorded inputs: the planner does not run again.
void ExpectThePayloadReplays(const std::vector<std::string>& overrides, bool plans) {
  constexpr std::int64_t kTwoMovesNs = 11'000'000'000;
  StackRun run(ShippedRig(overrides), ShippedExperiment("benchmark-waypoints"));
  run.Run(kTwoMovesNs);
  const std::string json = DesignToJson(run.design(), DesignHash(run.config()));
  ControlStep fresh(run.config(), DesignFromJson(json, run.config()));
  const FlushDenormals as_in_the_tasks;
  for (const TickRecord& record : run.tick) {
    const StepOutput output = fresh.Step(record.input);
    ASSERT_TRUE(SameBytes(output, record.output)) << "tick " << record.input.tick;
  }
  EXPECT_NEAR(run.tick.back().output.payload_kg, 0.1, 0.03);
  const auto planned =
      std::count_if(run.tick.begin(), run.tick.end(),
                    [](const TickRecord& record) { return record.input.planned != 0; });
  EXPECT_EQ(planned > 100, plans) << planned;
}

TEST(Determinism, RecordedInputsReplayWithThePayloadLawsToo) {
  ExpectThePayloadReplays({"controller.name=gain-scheduled"}, false);
  ExpectThePayloadReplays({"controller.name=receding-horizon"}, true);
}

// With lost frames as well: these have no reading of the accelerometer either.
TEST(Determinism, RecordedInputsReplayWithATipAccelerometerToo) {
  ExpectThePayloadReplays({"controller.name=gain-scheduled", "sim.lost_frame_fraction=0.1",
                           "sensors.tip_accelerometer={range_m_s2=50, converter_bits=14, "
                           "noise_counts=4, filter_hz=200}",
                           "estimator.payload.tip_extra_sigma_m_s2=0.2"},
                          false);
}

TEST(Determinism, RecordedInputsReplayWithDifferencesToo) {
  ExpectReplays(
      {"estimator.name=difference", "sensors.strain_input.filter_hz=0.0", "controller.alpha=2.0"});
}

TEST(Determinism, RecordedInputsReplayWithSixteenStatesToo) {
  ExpectReplays({"controller.nominal=T16"});
}

TEST(Determinism, RecordedInputsReplayWithOtherOutputsAndSkewToo) {
  ExpectReplays({"loop.output=at_once"});
  ExpectReplays({"sim.transport_delay_ms=14", "loop.actuation_delay_ms=14",
                 "sim.channel_skew_us=250", "sim.lost_frame_fraction=0.1"});
}

// Replay uses the design in the log: it must not change on the way through JSON.
TEST(Determinism, RecordedInputsReplayWithTheDesignFromItsJson) {
  const auto run = Recorded();
  const std::string json = DesignToJson(run->design(), DesignHash(run->config()));
  ControlStep fresh(run->config(), DesignFromJson(json, run->config()));
  const FlushDenormals as_in_the_tasks;
  for (const TickRecord& record : run->tick) {
    ASSERT_TRUE(SameBytes(fresh.Step(record.input), record.output)) << record.input.tick;
  }
}

}  // namespace
}  // namespace flexarm
