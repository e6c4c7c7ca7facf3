// The drive side of the simulated backend: permit, relay, charge pump and command age each remove
// the torque independently. In the complete stack they act together, so that one hides another.
// Also payload changes by an experiment.

#include "controller/tasks/plant_task.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "tests/controller/loop/stack_run.h"
#include "tests/support/loop_time.h"
#include "tests/support/no_alloc.h"

namespace flexarm {
namespace {

// Outputs of the other tasks in every millisecond.
struct World {
  SafetyState permit = SafetyState::kRunning;
  bool permit_renewed = true;
  bool relay_closed = true;
  bool pump_toggles = true;
  bool commands_go_on = true;
  std::int64_t running_since_ns = INT64_MIN;
  RunOrder run{};
};

// Replaces the control task.
class CountingTask final : public Task {
 public:
  Traits traits() const noexcept override {
    return {
        .name = "control", .period_ns = 20 * kMs, .phase_ns = 0, .deadline_ns = 1, .priority = 0};
  }
  void Run(const Activation& /*activation*/) noexcept override { ++runs; }

  int runs = 0;
};

class PlantTaskTest : public testing::Test {
 protected:
  explicit PlantTaskTest(const std::vector<std::string>& overrides = {})
      : task_(ShippedRig(overrides), 0.1, {0.0, 0.0},
              {.commands = &commands_,
               .permits = &permits_,
               .outputs = &outputs_,
               .presses = &presses_,
               .frames = &frames_,
               .levels = &levels_,
               .reports = &reports_,
               .truth = &truth_,
               .control = &control_}) {}

  // True state of the arm at a sample; drops earlier ones from the queue.
  PlantTruth TruthAt(std::int64_t tick) {
    TruthRecord record{};
    while (truth_.Pop(&record)) {
      if (record.tick == tick) return record.truth;
    }
    return {};
  }

  // Runs to `until_ns` with these outputs of the other tasks.
  // @returns the mean torque of joint 1 over the last 20 ms
  double RunTo(std::int64_t until_ns, const World& world) {
    while (now_ns_ < until_ns) {
      if (world.commands_go_on && now_ns_ % (20 * kMs) == 0) {
        commands_history_.Push(now_ns_, {.torque_nm = {2.0, 0.2}, .tick = now_ns_ / (20 * kMs)});
        commands_.Publish(commands_history_);
      }
      if (world.permit_renewed) {
        Permit permit = kNoPermit;
        permit.state = world.permit;
        permit.renewed_ns = now_ns_;
        permit.running_since_ns = world.running_since_ns;
        permit.run_number = 7;
        permit.run = world.run;
        permits_history_.Push(now_ns_, permit);
        permits_.Publish(permits_history_);
      }
      pump_ = world.pump_toggles ? !pump_ : pump_;
      outputs_history_.Push(now_ns_, {.relay_closed = world.relay_closed, .pump_level = pump_});
      outputs_.Publish(outputs_history_);
      now_ns_ += kMs;
      task_.Run({.due_ns = now_ns_, .missed_in_a_row = 0});
    }
    return frames_.Read().At(until_ns).value.applied_torque_nm[0];
  }

  std::int64_t now_ns_ = 0;
  bool pump_ = false;
  CommandHistory commands_history_{kNoCommand};
  PermitHistory permits_history_{kNoPermit};
  OutputHistory outputs_history_{{.relay_closed = false, .pump_level = false}};
  CommandChannel commands_{commands_history_};
  PermitChannel permits_{permits_history_};
  OutputChannel outputs_{outputs_history_};
  SpscQueue<LinePress> presses_{4};
  FrameChannel frames_{FrameHistory(kNoFrame)};
  LevelChannel levels_{LevelHistory(kHealthyLevels)};
  DriveReportChannel reports_{DriveReportHistory(kNoDriveReport)};
  SpscQueue<TruthRecord> truth_{64};
  CountingTask control_task_;
  FreezingTask control_{&control_task_};
  PlantTask task_;
};

TEST_F(PlantTaskTest, AppliesTheCommandWhileEverythingAllowsIt) {
  EXPECT_EQ(RunTo(40 * kMs, {}), 2.0);
  EXPECT_EQ(RunTo(60 * kMs, {}), 2.0);
}

TEST_F(PlantTaskTest, AFrameHasTheGateReasonsOfTheTorqueBeforeIt) {
  World world;
  RunTo(60 * kMs, world);
  EXPECT_EQ(frames_.Read().At(60 * kMs).value.gate_reasons, 0U);
  world.permit = SafetyState::kArmed;
  RunTo(80 * kMs, world);
  EXPECT_EQ(frames_.Read().At(80 * kMs).value.gate_reasons, std::uint32_t{kGateNotAllowed});
}

TEST(FreezingTask, RunsItsTaskOnlyBeforeTheInstant) {
  CountingTask inner;
  FreezingTask task(&inner);
  EXPECT_STREQ(task.traits().name, "control");
  task.Run({.due_ns = 20 * kMs, .missed_in_a_row = 0});
  task.FreezeFrom(40 * kMs);
  task.Run({.due_ns = 40 * kMs - 1, .missed_in_a_row = 0});
  EXPECT_EQ(inner.runs, 2);
  task.Run({.due_ns = 40 * kMs, .missed_in_a_row = 0});
  task.Run({.due_ns = 60 * kMs, .missed_in_a_row = 0});
  EXPECT_EQ(inner.runs, 2);
}

TEST_F(PlantTaskTest, APermitThatAllowsNoTorqueRemovesIt) {
  ASSERT_EQ(RunTo(40 * kMs, {}), 2.0);
  EXPECT_EQ(RunTo(60 * kMs, {.permit = SafetyState::kTripped}), 0.0);
}

TEST_F(PlantTaskTest, AnOpenRelayRemovesTheTorque) {
  ASSERT_EQ(RunTo(40 * kMs, {}), 2.0);
  EXPECT_EQ(RunTo(60 * kMs, {.relay_closed = false}), 0.0);
}

// Last renewed at 39 ms, the permit is 5 ms old at 44 and too old at 45: torque in five of the
// twenty milliseconds from 40 on.
TEST_F(PlantTaskTest, APermitOlderThanFiveMillisecondsRemovesTheTorque) {
  ASSERT_EQ(RunTo(40 * kMs, {}), 2.0);
  EXPECT_DOUBLE_EQ(RunTo(60 * kMs, {.permit_renewed = false}), 2.0 * 5.0 / 20.0);
}

// The pump last toggled at 39 ms; torque in the same five milliseconds.
TEST_F(PlantTaskTest, AStoppedChargePumpRemovesTheTorque) {
  ASSERT_EQ(RunTo(40 * kMs, {}), 2.0);
  EXPECT_DOUBLE_EQ(RunTo(60 * kMs, {.pump_toggles = false}), 2.0 * 5.0 / 20.0);
}

// The last command acts from 20 ms on and is valid for two periods: to 60 ms, and for that
// millisecond.
TEST_F(PlantTaskTest, ACommandOlderThanTwoPeriodsRemovesTheTorque) {
  ASSERT_EQ(RunTo(40 * kMs, {}), 2.0);
  EXPECT_EQ(RunTo(60 * kMs, {.commands_go_on = false}), 2.0);
  EXPECT_DOUBLE_EQ(RunTo(80 * kMs, {.commands_go_on = false}), 2.0 * 1.0 / 20.0);
  EXPECT_EQ(RunTo(100 * kMs, {.commands_go_on = false}), 0.0);
}

TEST_F(PlantTaskTest, AChangeOfPayloadDoesNotAllocate) {
  PlannedExperiment planned(std::vector<std::array<double, 2>>(10));
  planned.sim_events = {PayloadEvent(0.0, 0.8), PayloadEvent(0.04, 0.0)};
  RunTo(20 * kMs, {});
  {
    const NoAlloc armed;
    RunTo(200 * kMs, {.running_since_ns = 20 * kMs, .run = {.experiment = &planned}});
  }
  EXPECT_EQ(task_.released(), 7u) << "the experiment was not read";
}

Experiment WithPayload(double at_s, double payload_kg) {
  Experiment experiment = ShippedExperiment();
  experiment.sim_event = {PayloadEvent(at_s, payload_kg)};
  return experiment;
}

std::unique_ptr<StackRun> Recorded(const Experiment& experiment, double payload_kg) {
  auto run = std::make_unique<StackRun>(ShippedRig(), experiment, payload_kg);
  run->Run(4'000 * kMs);
  return run;
}

TEST(PlantTaskPayload, AChangeToTheSamePayloadHasNoEffect) {
  EXPECT_TRUE(
      SameTicks(*Recorded(WithPayload(0.5, 0.1), 0.1), *Recorded(ShippedExperiment(), 0.1)));
}

// The arm rests at zero until the experiment starts, so the payload before has no effect.
TEST(PlantTaskPayload, AChangeAtTheStartEqualsARunWithThatPayload) {
  const auto changed = Recorded(WithPayload(0.0, 0.3), 0.1);
  EXPECT_TRUE(SameTicks(*changed, *Recorded(ShippedExperiment(), 0.3)));
  EXPECT_FALSE(SameTicks(*changed, *Recorded(ShippedExperiment(), 0.1)));
}

// During a torque pulse: the frame of that instant is the last one without an effect.
TEST(PlantTaskPayload, AChangeActsFromItsInstantOn) {
  const auto changed = Recorded(WithPayload(0.4, 0.3), 0.1);
  const auto plain = Recorded(ShippedExperiment(), 0.1);
  const auto [first, other] = std::mismatch(
      changed->tick.begin(), changed->tick.end(), plain->tick.begin(),
      [](const TickRecord& a, const TickRecord& b) { return a.truth.tip_m == b.truth.tip_m; });
  ASSERT_NE(first, changed->tick.end());
  EXPECT_EQ(first->input.sampling_instant_ns, changed->ExperimentStart() + 420 * kMs);
}

class LatePlantTaskTest : public PlantTaskTest {
 protected:
  LatePlantTaskTest()
      : PlantTaskTest({"sim.transport_delay_ms=40", "loop.actuation_delay_ms=20"}) {}
};

// Commands from 0 ms on; the declared delay is 20 ms, the true one 40 ms. The record of the true
// state has the true delay.
TEST_F(LatePlantTaskTest, ReportedTorquesHaveTheDeclaredDelayOnly) {
  EXPECT_EQ(RunTo(20 * kMs, {}), 0.0);
  EXPECT_EQ(RunTo(40 * kMs, {}), 2.0);
  EXPECT_EQ(TruthAt(2).hub_angle_rad[0], 0.0);
  EXPECT_EQ(RunTo(60 * kMs, {}), 2.0);
  EXPECT_GT(TruthAt(3).hub_angle_rad[0], 0.0);
}

class LossyPlantTaskTest : public PlantTaskTest {
 protected:
  LossyPlantTaskTest() : PlantTaskTest({"sim.lost_frame_fraction=0.5"}) {}
};

// Every second frame is lost: it holds no reading, the next one holds all; the drive continues.
TEST_F(LossyPlantTaskTest, ALostFrameHoldsNoReadingAndTheDriveContinues) {
  ASSERT_EQ(RunTo(40 * kMs, {}), 2.0);
  const bool at_40 = frames_.Read().At(40 * kMs).value.frame.counter_valid != 0;
  for (int k = 3; k < 10; ++k) {
    const std::int64_t instant_ns = 20 * kMs * k;
    EXPECT_EQ(RunTo(instant_ns, {}), 2.0);
    const FramePacket& packet = frames_.Read().At(instant_ns).value;
    const bool whole = at_40 == (k % 2 == 0);
    EXPECT_EQ(packet.frame.sampled_at_ns, instant_ns);
    EXPECT_EQ(packet.frame.counter_valid, whole ? 0xfu : 0u) << k;
    EXPECT_EQ(packet.frame.strain_valid, whole ? 0xfffffu : 0u) << k;
    EXPECT_TRUE(TruthAt(k).known);
  }
}

class MultiplexedPlantTaskTest : public PlantTaskTest {
 protected:
  MultiplexedPlantTaskTest() : PlantTaskTest({"sim.channel_skew_us=250"}) {}
};

// The last of twenty channels is sampled 4.75 ms after the instant that the frame belongs to.
TEST_F(MultiplexedPlantTaskTest, AFrameIsPublishedWithItsLastChannel) {
  RunTo(44 * kMs, {});
  EXPECT_EQ(frames_.Read().Newest().value.frame.sampled_at_ns, 20 * kMs);
  RunTo(45 * kMs, {});
  const FramePacket& packet = frames_.Read().At(40 * kMs).value;
  EXPECT_EQ(packet.frame.sampled_at_ns, 40 * kMs);
  EXPECT_EQ(packet.frame.strain_valid, 0xfffffu);
  EXPECT_EQ(packet.frame.strain_offset_ns[19], 4'750'000);
  EXPECT_EQ(packet.applied_torque_nm[0], 2.0);
}

}  // namespace
}  // namespace flexarm
