// What the control task gives to a step: its instants, frame, levels, delay, resets; and what it
// makes of the result.

#include "controller/tasks/control_task.h"

#include "tests/controller/tasks/control_task_bench.h"

namespace flexarm {
namespace {

using enum SafetyState;

TEST_F(ControlTaskTest, IsDueOnTheGrid) {
  const Task::Traits traits = task_.traits();
  EXPECT_STREQ(traits.name, "control");
  EXPECT_EQ(traits.period_ns, kPeriodNs);
  EXPECT_EQ(traits.phase_ns, kPhaseNs);
  EXPECT_EQ(traits.deadline_ns, kDeadlineNs);
  EXPECT_EQ(traits.priority, 80);
}

TEST_F(ControlTaskTest, AStepHasTheFrameOfItsSamplingInstant) {
  for (const std::int64_t tick : {0, 1, 2}) {
    FramePacket packet = Healthy(tick);
    packet.frame.counter[2] = static_cast<std::uint32_t>(tick);
    packet.applied_torque_nm = {0.5, -0.25};
    packet.gate_reasons = 3;
    const TickRecord record = Step(packet);
    EXPECT_EQ(record.input.tick, tick);
    EXPECT_EQ(record.input.now_ns, DueNs(tick));
    EXPECT_EQ(record.input.sampling_instant_ns, tick * kPeriodNs);
    EXPECT_EQ(record.input.frame.sampled_at_ns, tick * kPeriodNs);
    EXPECT_EQ(record.input.frame.counter[2], static_cast<std::uint32_t>(tick));
    EXPECT_EQ(record.input.applied_torque_nm, (std::array{0.5, -0.25}));
    EXPECT_EQ(record.gate_reasons, 3U);
    EXPECT_EQ(record.output.tick, tick);
    EXPECT_EQ(record.run_number, 0U);
  }
}

// A frame of the next instant that is there already is not used.
TEST_F(ControlTaskTest, AFrameOfALaterInstantWaits) {
  Send(0, 0, Healthy(0));
  Send(0, 1, Healthy(1));
  EXPECT_EQ(StepWithoutFrame().input.frame.sampled_at_ns, 0);
  EXPECT_EQ(StepWithoutFrame().input.frame.sampled_at_ns, kPeriodNs);
}

TEST_F(ControlTaskTest, TheReadingsOfTheBusesAreJoined) {
  FramePacket drives = Healthy(0), gauges = Healthy(0);
  drives.frame.strain_valid = 0;
  drives.frame.counter[0] = 5;
  gauges.frame.counter_valid = 0;
  gauges.frame.strain[19] = 7;
  Send(1, 0, gauges);
  const StepInput input = Step(drives).input;
  EXPECT_EQ(input.frame.counter_valid, 0b1111U);
  EXPECT_EQ(input.frame.strain_valid, 0xFFFFFU);
  EXPECT_EQ(input.frame.counter[0], 5U);
  EXPECT_EQ(input.frame.strain[19], 7);
}

TEST_F(ControlTaskTest, APermitHoldsForTheStepsAfterIt) {
  permit_.state = kIdle;
  AllowFrom(DueNs(0));
  EXPECT_EQ(Step().input.safety_state, kStarting) << "published when the step was due";
  EXPECT_EQ(Step().input.safety_state, kIdle);
  permit_.state = kArmed;
  permit_.reduced = true;
  AllowFrom(DueNs(2) - 1);
  const StepInput armed = Step().input;
  EXPECT_EQ(armed.safety_state, kArmed);
  EXPECT_EQ(armed.reduced, 1);
}

TEST_F(ControlTaskTest, TheLimitsAreFullUnlessThePermitReducesThem) {
  Allow(kIdle);
  EXPECT_EQ(Step().input.reduced, 0);
}

// A switch that was open for a millisecond since the step before is open in this one.
TEST_F(ControlTaskTest, ASwitchThatOpensForAMomentIsOpen) {
  Allow(kIdle);
  EXPECT_EQ(Step().input.frame.levels, kHealthyLevels);
  const LineLevels open = kHealthyLevels & ~LineBit(Line::kLimit1High);
  permit_.levels = open;
  AllowFrom(DueNs(0) + kMs);
  permit_.levels = kHealthyLevels;
  AllowFrom(DueNs(0) + 2 * kMs);
  EXPECT_EQ(Step().input.frame.levels, open);
  EXPECT_EQ(Step().input.frame.levels, kHealthyLevels);
}

// Each permit belongs to one step: that from a millisecond before it up to the next.
TEST_F(ControlTaskTest, ALevelIsSeenByOneStep) {
  const LineLevels open = kHealthyLevels & ~LineBit(Line::kLimit2Low);
  Step();
  permit_.levels = open;
  AllowFrom(DueNs(1) - 1);  // the last that step 1 reads
  permit_.levels = kHealthyLevels;
  AllowFrom(DueNs(1));
  EXPECT_EQ(Step().input.frame.levels, open);
  EXPECT_EQ(Step().input.frame.levels, kHealthyLevels);
}

TEST_F(ControlTaskTest, TheFirstStepIsAResetAndTheOneAfterArming) {
  Allow(kIdle);
  EXPECT_EQ(Step().input.reset, 1);
  EXPECT_EQ(Step().input.reset, 0);
  Allow(kArmed);
  EXPECT_EQ(Step().input.reset, 1);
  EXPECT_EQ(Step().input.reset, 0);
  Allow(kIdle);
  EXPECT_EQ(Step().input.reset, 0);
}

TEST_F(ControlTaskTest, AResetThatCameWithASkippedPermitIsNotLost) {
  Allow(kIdle);
  Step();
  Allow(kArmed);
  Run(1, nullptr);
  EXPECT_EQ(Step().input.reset, 1);
}

TEST_F(ControlTaskTest, CountsContinueOverAReset) {
  FramePacket turned = Healthy(0);
  turned.frame.counter[1] = 9;
  const std::int64_t counts = Step(turned).output.counts[1];
  EXPECT_EQ(counts, 9);
  Allow(kArmed);
  turned.frame.sampled_at_ns = kPeriodNs;
  EXPECT_EQ(Step(turned).input.counts_before[1], counts);
}

TEST_F(ControlTaskTest, ACalibrationIsTakenWithoutTorqueAndIsAReset) {
  Calibration zeros{};
  zeros.counter_zero[0] = 12;
  Allow(kArmed);
  Step();
  Run(1, nullptr);
  Step();
  calibrations_.Publish(zeros);
  const StepInput running = Step().input;
  EXPECT_EQ(running.calibration, Calibration{}) << "torque is allowed";
  EXPECT_EQ(running.reset, 0);
  Allow(kArmed);
  const StepInput taken = Step().input;
  EXPECT_EQ(taken.calibration, zeros);
  EXPECT_EQ(taken.reset, 1);
  EXPECT_EQ(Step().input.reset, 0) << "once";
}

// The instant at which the command before acted, as its drive says; else the known one.
TEST_F(ControlTaskTest, TheDelayIsTheMeasuredOneOfTheCommandBefore) {
  const auto late_ns = [this](std::int64_t output_tick, std::int64_t after_ns) {
    FramePacket packet = Healthy(next_tick_);
    packet.output_tick = output_tick;
    packet.acted_ns = next_tick_ * kPeriodNs + after_ns;
    const StepInput input = Step(packet).input;
    EXPECT_EQ(input.acts_late_ns, input.acted_late_ns);
    return input.acted_late_ns;
  };
  EXPECT_EQ(late_ns(-1, 3 * kMs), 0) << "there is no command yet";
  EXPECT_EQ(late_ns(0, 3 * kMs), 3 * kMs);
  EXPECT_EQ(late_ns(0, 3 * kMs), 0) << "an older command";
  EXPECT_EQ(late_ns(3, 3 * kMs), 0) << "a later one";
  EXPECT_EQ(late_ns(3, -kMs), 0) << "not before it was put out";
  EXPECT_EQ(late_ns(4, 3 * kPeriodNs), kPeriodNs) << "a period later at most";
}

class LateControlTaskTest : public ControlTaskTest {
 protected:
  // Put out 15 ms after the sampling instant, 5 ms before the next; acts 2 ms later.
  LateControlTaskTest()
      : ControlTaskTest({kThesisLaw, "loop.output=at_once", "loop.output_after_ms=15",
                         "loop.actuation_delay_ms=2"}) {}
};

TEST_F(LateControlTaskTest, TheDelayCountsFromTheGridOfTheOutputs) {
  EXPECT_EQ(Step().input.acted_late_ns, -3 * kMs);
  FramePacket packet = Healthy(1);
  packet.output_tick = 0;
  packet.acted_ns = kPeriodNs - 4 * kMs;
  EXPECT_EQ(Step(packet).input.acted_late_ns, -3 * kMs);
  packet = Healthy(2);
  packet.output_tick = 1;
  packet.acted_ns = 2 * kPeriodNs + kPeriodNs;
  EXPECT_EQ(Step(packet).input.acted_late_ns, kPeriodNs - 3 * kMs);
}

TEST_F(LateControlTaskTest, ACommandHoldsFromItsOutputOn) {
  Step();
  EXPECT_EQ(commands_[0].Read().Newest().from_ns, 15 * kMs);
}

TEST_F(ControlTaskTest, EveryBusGetsTheCommandAndSafetyTheReport) {
  Step();
  for (CommandChannel& channel : commands_) {
    EXPECT_EQ(channel.Read().Newest().from_ns, kPeriodNs) << "the next sampling instant";
    EXPECT_EQ(channel.Read().Newest().value.tick, 0);
  }
  const auto& report = reports_.Read().Newest();
  EXPECT_EQ(report.from_ns, DueNs(0) + kDeadlineNs);
  EXPECT_EQ(report.value.tick, 0);
  EXPECT_EQ(report.value.due_ns, DueNs(0));
  EXPECT_EQ(report.value.faults, 0U);
  EXPECT_FALSE(report.value.at_rest);
  EXPECT_TRUE(report.value.may_damp);
  EXPECT_EQ(report.value.missed_in_a_row, 0);
  for (int k = 0; k < 40; ++k) Step();
  EXPECT_TRUE(reports_.Read().Newest().value.at_rest);
}

// A zero because of a fault acts from the deadline of the step on, not a period later.
TEST_F(ControlTaskTest, AFaultCutsTheTorqueAtTheDeadline) {
  Allow(kIdle);
  Step();
  FramePacket jumped = Healthy(1);
  jumped.frame.counter[0] = 120;  // of 2540: 14.8 rad/s
  Step(jumped);
  EXPECT_EQ(commands_[0].Read().Newest().from_ns, DueNs(1) + kDeadlineNs);
  const ControlReport& report = reports_.Read().Newest().value;
  EXPECT_NE(report.faults & CauseBit(TripCause::kEncoderJump), 0U);
  EXPECT_EQ(report.evidence.channel, 1U);
  EXPECT_GT(report.evidence.limit, 0.0);
  EXPECT_EQ(report.evidence.detail, 0U);
}

// Damping torque after a fault of the arm alone is predicted for the usual instant.
TEST_F(ControlTaskTest, AFaultThatIsDampedKeepsTheInstantOfTheTorque) {
  Allow(kIdle);
  TickRecord record{};
  FramePacket turned = Healthy(0);
  while (record.output.faults == 0 && next_tick_ < 100) {
    turned.frame.sampled_at_ns = next_tick_ * kPeriodNs;
    record = Step(turned);
    turned.frame.counter[0] += 20;  // of 2540 in 20 ms: 2.5 rad/s
    turned.frame.counter[2] += 20;
    for (auto& reading : turned.frame.strain) reading ^= 1;  // else they are stuck
  }
  ASSERT_EQ(record.output.faults, CauseBit(TripCause::kSoftLimit1));
  ASSERT_EQ(record.output.may_damp, 1);
  EXPECT_EQ(commands_[0].Read().Newest().from_ns, next_tick_ * kPeriodNs);
}

TEST_F(ControlTaskTest, TheStepsOwnEvidenceIsReported) {
  Allow(kIdle);
  TickRecord record{};
  for (int k = 0; k < 2; ++k) {  // the second sample without a reading
    FramePacket silent = Healthy(k);
    silent.frame.counter_valid = 0b1011;
    record = Step(silent);
  }
  ASSERT_EQ(record.output.faults, CauseBit(TripCause::kNoCounterReading));
  const ControlReport& report = reports_.Read().Newest().value;
  EXPECT_EQ(report.faults, record.output.faults);
  EXPECT_EQ(report.evidence.value, 2.0);
  EXPECT_EQ(report.evidence.limit, 2.0);
  EXPECT_EQ(report.evidence.channel, 3U);
  EXPECT_EQ(report.evidence.detail, 0U);
  EXPECT_EQ(report.may_damp, record.output.may_damp != 0);
}

// A deadline is judged when the next activation tells of it; a period without an activation has
// missed its own.
TEST_F(ControlTaskTest, MissedDeadlinesAreCountedInTheWindow) {
  const auto count = [this] { return reports_.Read().Newest().value.missed_in_window; };
  Step(Healthy(0), 1);
  EXPECT_EQ(count(), 0) << "of the first activation nothing is known";
  Step(Healthy(1), 1);
  EXPECT_EQ(count(), 1);
  EXPECT_EQ(reports_.Read().Newest().value.missed_in_a_row, 1);
  Step(Healthy(2), 0);
  EXPECT_EQ(count(), 1);
  next_tick_ += 3;
  Step(Healthy(next_tick_), 3);
  EXPECT_EQ(count(), 4) << "three periods were skipped, and the one before them was in time";
  next_tick_ += 2;
  Step(Healthy(next_tick_), 3);
  EXPECT_EQ(count(), 7) << "two were skipped, and the one before them was late";
  for (int k = 0; k < kWindow; ++k) Step();
  EXPECT_EQ(count(), 0) << "they have left the window";
}

}  // namespace
}  // namespace flexarm
