// Switches, emergency stop and frozen threads while the arm runs: the reaction time, the name of
// the cause, and no recovery without the operator.
//
// Torque is observed at the frames: their applied torque is the mean over 20 slices of 1 ms, and
// the command is constant over a period, so mean / command * 20 is the number of milliseconds with
// torque, exact to the slew limit's ramp.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/controller/loop/stack_run.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

SimEvent LineEvent(double at_s, Line line) {
  return {.at_s = at_s, .line = line, .level = 0, .freeze = FreezeTarget::kNone, .kill = false};
}

SimEvent FreezeEvent(double at_s, FreezeTarget target) {
  return {.at_s = at_s, .line = {}, .level = 0, .freeze = target, .kill = false};
}

Experiment WithEvent(const SimEvent& event) {
  Experiment experiment = ShippedExperiment();
  experiment.sim_event = {event};
  return experiment;
}

// The shipped experiment with one event, until 5 s after it.
class EventRun : public StackRun {
 public:
  EventRun(const RigConfig& config, const SimEvent& event) : StackRun(config, WithEvent(event)) {
    while (permit().running_since_ns == INT64_MIN) Run(now_ns() + 20 * kMs);
    event_ns_ = ExperimentStart() + std::llround(event.at_s * 1e9);
    Run(event_ns_ + 5'000 * kMs);
  }

  std::int64_t event_ns() const { return event_ns_; }

 private:
  std::int64_t event_ns_ = 0;
};

const SafetyRecord& Trip(const StackRun& run) {
  const auto found = std::find_if(run.safety.begin(), run.safety.end(), [](const SafetyRecord& r) {
    return r.before.state != SafetyState::kTripped && r.after.state == SafetyState::kTripped;
  });
  EXPECT_NE(found, run.safety.end()) << "no trip";
  return found != run.safety.end() ? *found : run.safety.back();
}

// Tripped at the end with the first cause, and never left in between.
void ExpectLatched(StackRun* run, TripCause cause) {
  const SafetyRecord& trip = Trip(*run);
  EXPECT_STREQ(ToString(trip.after.cause), ToString(cause));
  EXPECT_STREQ(ToString(run->permit().cause), ToString(cause));
  EXPECT_EQ(run->permit().state, SafetyState::kTripped);
  for (const SafetyRecord& record : run->safety) {
    if (record.due_ns <= trip.due_ns) continue;
    EXPECT_EQ(record.after.state, SafetyState::kTripped);
    EXPECT_EQ(record.after.cause, cause);
  }
}

// Milliseconds with torque on joint 1 in the period that ends at `sampled_ns`.
double MillisecondsWithTorque(const StackRun& run, std::int64_t sampled_ns) {
  const std::int64_t period_ns = run.grid().period_ns;
  const auto at = [&run](std::int64_t instant_ns) {
    return std::find_if(run.tick.begin(), run.tick.end(), [instant_ns](const TickRecord& r) {
      return r.input.sampling_instant_ns == instant_ns;
    });
  };
  const auto command = at(sampled_ns - 2 * period_ns), frame = at(sampled_ns);
  EXPECT_NE(command, run.tick.end());
  EXPECT_NE(frame, run.tick.end());
  return frame->input.applied_torque_nm[0] / command->output.torque_nm[0] * 20.0;
}

struct SwitchCase {
  Line line;
  TripCause cause;
  std::uint32_t channel;
};

class SwitchReaction : public testing::TestWithParam<SwitchCase> {};

// The level changes at 0.317 s, between two frames; the ticks at 0.318 and 0.319 s sample it, and
// two samples count. The safety task writes relay and permit in the same tick, so the instant of
// the trip record is that of the relay.
TEST_P(SwitchReaction, OpensTheRelayAtTheSecondTickAndRemovesTheTorqueWithinThreeMilliseconds) {
  EventRun run(ShippedRig(), LineEvent(0.317, GetParam().line));
  ExpectLatched(&run, GetParam().cause);
  // The second tick that sees the level.
  EXPECT_EQ(Trip(run).due_ns, run.event_ns() + 2 * kMs - SafetyTask::kLeadNs);
  EXPECT_EQ(Trip(run).evidence.value, 0.0);
  EXPECT_EQ(Trip(run).evidence.limit, 1.0);
  EXPECT_EQ(Trip(run).evidence.channel, GetParam().channel);
  // 0.300 .. 0.320: torque until the second tick after the event, 19 ms; at most 20 by the
  // contract.
  const std::int64_t period_end_ns = run.ExperimentStart() + 320 * kMs;
  EXPECT_NEAR(MillisecondsWithTorque(run, period_end_ns), 19.0, 1e-9);
  for (const TickRecord& record : run.tick) {
    if (record.input.sampling_instant_ns <= period_end_ns) continue;
    EXPECT_EQ(record.input.applied_torque_nm[0], 0.0);
    EXPECT_EQ(record.input.applied_torque_nm[1], 0.0);
    EXPECT_EQ(record.output.torque_nm[0], 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Lines, SwitchReaction,
    testing::Values(SwitchCase{Line::kLimit1Low, TripCause::kLimitSwitch1Low, 1},
                    SwitchCase{Line::kLimit1High, TripCause::kLimitSwitch1High, 1},
                    SwitchCase{Line::kLimit2Low, TripCause::kLimitSwitch2Low, 2},
                    SwitchCase{Line::kLimit2High, TripCause::kLimitSwitch2High, 2},
                    SwitchCase{Line::kEmergencyStop, TripCause::kEmergencyStop, 0}),
    [](const auto& shown) { return "Line" + std::to_string(static_cast<int>(shown.param.line)); });

class FreezePhase : public testing::TestWithParam<int> {};  // ms into the control period

// A frozen plant sends neither frames nor reports. Whether the safety task (stale frame) or the
// loop (two periods without a reading) detects it first depends on the phase; both react within two
// periods and 2 ms.
TEST_P(FreezePhase, OfThePlantTripsWithinTwoPeriodsAndTwoMilliseconds) {
  const double at_s = 0.3 + 1e-3 * GetParam();
  EventRun run(ShippedRig(), FreezeEvent(at_s, FreezeTarget::kPlant));
  const SafetyRecord& trip = Trip(run);
  EXPECT_LE(trip.due_ns - run.event_ns(), 42 * kMs);
  EXPECT_GT(trip.due_ns - run.event_ns(), 20 * kMs) << "one late frame is no fault";
  EXPECT_TRUE(trip.after.cause == TripCause::kStaleFrame ||
              trip.after.cause == TripCause::kNoCounterReading)
      << ToString(trip.after.cause);
  EXPECT_GT(trip.evidence.limit, 0.0);
  EXPECT_GE(trip.evidence.value, trip.evidence.limit);
  ExpectLatched(&run, trip.after.cause);
}

// A frozen control thread is detected by its heartbeat, and its last command expires.
TEST_P(FreezePhase, OfTheControlTaskTripsWithinTwoPeriodsAndTwoMilliseconds) {
  const double at_s = 0.3 + 1e-3 * GetParam();
  EventRun run(ShippedRig(), FreezeEvent(at_s, FreezeTarget::kControl));
  ExpectLatched(&run, TripCause::kControlHeartbeatLost);
  const SafetyRecord& trip = Trip(run);
  EXPECT_LE(trip.due_ns - run.event_ns(), 42 * kMs);
  EXPECT_GT(trip.due_ns - run.event_ns(), 20 * kMs);
  // Evidence: the age of the heartbeat at the first tick that is over its limit of two periods.
  EXPECT_DOUBLE_EQ(trip.evidence.limit, 0.040);
  EXPECT_NEAR(trip.evidence.value, 0.0409, 1e-9);
  EXPECT_LT(run.tick.back().input.now_ns, run.event_ns());
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, FreezePhase, testing::Values(0, 1, 7, 9, 10, 11, 19));

// The cause has gone, the arm is at rest, the button is pressed: still only the operator's reset
// leaves Tripped, towards Idle. Each of the two resets alone is refused with its reason.
TEST(TripReset, NeedsTheButtonAndTheOperatorAndLeadsToIdle) {
  // At 2.6 s, in the rest between the moves: the arm soon comes to rest without torque.
  EventRun run(ShippedRig(), LineEvent(2.6, Line::kEmergencyStop));
  ExpectLatched(&run, TripCause::kEmergencyStop);

  EXPECT_EQ(run.Ask(RequestKind::kArm), Refusal::kWrongState);
  EXPECT_EQ(run.Ask(RequestKind::kReset), Refusal::kCauseRemains);
  run.Press(Line::kEmergencyStop, 1);
  EXPECT_EQ(run.Ask(RequestKind::kReset), Refusal::kNoReset);
  run.Press(Line::kResetButton, 1);
  run.Run(run.now_ns() + 40 * kMs, false);  // with the 20 ms before, longer than 50 ms
  run.Press(Line::kResetButton, 0);
  run.Run(run.now_ns() + 5'000 * kMs, false);
  EXPECT_EQ(run.permit().state, SafetyState::kTripped) << "the button alone resets nothing";
  EXPECT_EQ(run.Ask(RequestKind::kReset), Refusal::kNone);
  EXPECT_EQ(run.permit().state, SafetyState::kIdle);
  run.Run(run.now_ns() + 5'000 * kMs, false);
  EXPECT_EQ(run.permit().state, SafetyState::kIdle) << "nothing arms by itself";
  EXPECT_EQ(run.tick.back().input.applied_torque_nm[0], 0.0);

  // The arm can be used again.
  EXPECT_EQ(run.Ask(RequestKind::kArm), Refusal::kNone);
  EXPECT_EQ(run.permit().state, SafetyState::kArmed);
}

// The torque is removed equally fast if it is output at once or a period and a half later.
class OutputTimingReaction : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(OutputTimingReaction, ASwitchRemovesTheTorqueWithinThreeMilliseconds) {
  EventRun run(ShippedRig(GetParam()), LineEvent(0.317, Line::kEmergencyStop));
  ExpectLatched(&run, TripCause::kEmergencyStop);
  EXPECT_EQ(Trip(run).due_ns, run.event_ns() + 2 * kMs - SafetyTask::kLeadNs);
  // The mean over the period of the event includes the milliseconds until three after the event;
  // later means are zero.
  const std::int64_t period_ns = run.grid().period_ns;
  for (const TickRecord& record : run.tick) {
    if (record.input.sampling_instant_ns < run.event_ns() + 3 * kMs + period_ns) continue;
    EXPECT_EQ(record.input.applied_torque_nm, (std::array{0.0, 0.0}));
  }
}

TEST_P(OutputTimingReaction, AFrozenLoopStopsTheArmWithinTwoPeriodsAndTwoMilliseconds) {
  EventRun run(ShippedRig(GetParam()), FreezeEvent(0.3, FreezeTarget::kControl));
  ExpectLatched(&run, TripCause::kControlHeartbeatLost);
  EXPECT_LE(Trip(run).due_ns, run.event_ns() + 2 * run.grid().period_ns + 2 * kMs);
}

INSTANTIATE_TEST_SUITE_P(Outputs, OutputTimingReaction,
                         testing::Values(std::vector<std::string>{"loop.output=at_once"},
                                         std::vector<std::string>{
                                             "loop.output=at_once", "loop.acquire_before_ms=3",
                                             "loop.step_deadline_ms=2", "loop.output_after_ms=5"},
                                         std::vector<std::string>{"sim.transport_delay_ms=30",
                                                                  "loop.actuation_delay_ms=30"}));

}  // namespace
}  // namespace flexarm
