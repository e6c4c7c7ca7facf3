#include "controller/safety/safety_monitor.h"

#include <gtest/gtest.h>

#include "controller/types/runtime_config.h"
#include "controller/types/safety_config.h"
#include "tests/controller/safety/monitored_arm.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using enum SafetyState;

TripCauses PresentIn(const SafetyInputs& in) {
  SafetyMonitor supervisor(kLimits);
  return supervisor.Judge(in).present;
}

TEST(SafetyMonitor, FindsNoCauseWithoutAFault) {
  SafetyMonitor supervisor(kLimits);
  const SafetyFacts facts = supervisor.Judge(Fine());
  EXPECT_EQ(facts.present, 0u);
  EXPECT_EQ(facts.all_reported, 1);
  EXPECT_EQ(facts.at_rest, 0);
  EXPECT_EQ(facts.experiment_done, 0);
  EXPECT_EQ(facts.stop_expired, 0);
  EXPECT_EQ(facts.reset_pressed, 0);
  EXPECT_EQ(supervisor.timing(), TimingCounts{});
}

TEST(SafetyMonitor, NamesEachOpenSwitchAndTheEmergencyStop) {
  const struct {
    Line line;
    TripCause cause;
    std::uint32_t joint;
  } cases[] = {{Line::kLimit1Low, TripCause::kLimitSwitch1Low, 1},
               {Line::kLimit1High, TripCause::kLimitSwitch1High, 1},
               {Line::kLimit2Low, TripCause::kLimitSwitch2Low, 2},
               {Line::kLimit2High, TripCause::kLimitSwitch2High, 2},
               {Line::kEmergencyStop, TripCause::kEmergencyStop, 0}};
  for (const auto& c : cases) {
    SafetyInputs in = Fine();
    in.levels &= ~LineBit(c.line);
    EXPECT_EQ(PresentIn(in), CauseBit(c.cause)) << ToString(c.cause);
    ExpectEvidence(c.cause, in, 0.0, 1.0, c.joint);
  }
  SafetyInputs in = Fine();
  in.levels = 0;  // the cable of the whole chain is cut
  EXPECT_EQ(PresentIn(in), 0b111110u);
}

TEST(SafetyMonitor, ControlHeartbeatIsLostAfterTwoPeriodsAndNotBefore) {
  SafetyInputs in = Fine();
  in.control_alive_ns = in.due_ns - 40 * kMs;
  EXPECT_EQ(PresentIn(in), 0u);
  in.control_alive_ns = in.due_ns - 41 * kMs;
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kControlHeartbeatLost));
  ExpectEvidence(TripCause::kControlHeartbeatLost, in, 0.041, 0.040, 0);
}

TEST(SafetyMonitor, AReportThatIsNotYetValidKeepsTheHeartbeat) {
  SafetyInputs in = Fine();
  in.control.due_ns = in.due_ns - 41 * kMs;  // one period was skipped
  in.control_alive_ns = in.due_ns - 1 * kMs;
  EXPECT_EQ(PresentIn(in), 0u);
}

TEST(SafetyMonitor, StaleDriveSideIsAStaleFrame) {
  SafetyInputs in = Fine();
  in.drive_alive_ns = in.due_ns - 40 * kMs;
  EXPECT_EQ(PresentIn(in), 0u);
  in.drive_alive_ns = in.due_ns - 41 * kMs;
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kStaleFrame));
  ExpectEvidence(TripCause::kStaleFrame, in, 0.041, 0.040, 0);
}

TEST(SafetyMonitor, AReportedBusOrDriveFaultIsACause) {
  SafetyInputs in = Fine();
  in.drive.bus_ok = false;
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kBusLost));
  ExpectEvidence(TripCause::kBusLost, in, 0.0, 1.0, 0);
  in.drive = {.due_ns = in.due_ns, .bus_ok = true, .drive_ok = false};
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kDriveFault));
}

TEST(SafetyMonitor, TheEvidenceNamesTheBusAndItsFault) {
  SafetyInputs in = Fine();
  in.drive.bus_ok = in.drive.drive_ok = false;
  in.troubles = {.lost = {.bus = 3, .fault = {.kind = 1, .node = 2, .code = 7}},
                 .drive = {.bus = 1, .fault = {.kind = 5, .node = 0, .code = 0x2310}},
                 .oldest_bus = 2};
  const SafetyMonitor supervisor(kLimits);
  const Evidence lost = supervisor.EvidenceOf(TripCause::kBusLost, in);
  EXPECT_EQ(lost.channel, 3u);
  EXPECT_EQ(FaultFromBits(lost.detail), in.troubles.lost.fault);
  const Evidence drive = supervisor.EvidenceOf(TripCause::kDriveFault, in);
  EXPECT_EQ(drive.channel, 1u);
  EXPECT_EQ(FaultFromBits(drive.detail), in.troubles.drive.fault);
  const Evidence stale = supervisor.EvidenceOf(TripCause::kStaleFrame, in);
  EXPECT_EQ(stale.channel, 2u);
  EXPECT_EQ(FaultFromBits(stale.detail).kind, kBusHangs);
}

TEST(SafetyMonitor, DeadlinesMissedInARowTripAtTheConfiguredNumber) {
  SafetyInputs in = Fine();
  in.control.missed_in_a_row = 2;
  EXPECT_EQ(PresentIn(in), 0u);
  in.control.missed_in_a_row = 3;
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kMissedDeadlines));
  ExpectEvidence(TripCause::kMissedDeadlines, in, 3.0, 3.0, 0);
}

TEST(SafetyMonitor, APermitOlderThanAllowedIsAnOverrunInThatTickOnly) {
  SafetyInputs in = Fine();
  in.permit_age_ns = 5 * kMs;
  EXPECT_EQ(PresentIn(in), 0u);
  in.permit_age_ns = 5 * kMs + 1;
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kSafetyOverrun));
  in.permit_age_ns = 21 * kMs;
  ExpectEvidence(TripCause::kSafetyOverrun, in, 0.021, 0.005, 0);
}

TEST(SafetyMonitor, DeadlinesMissedInTheWindowTripAtTheConfiguredNumber) {
  SafetyInputs in = Fine();
  in.control.missed_in_window = 15;
  EXPECT_EQ(PresentIn(in), 0u);
  in.control.missed_in_window = 16;
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kDeadlinesOftenMissed));
  ExpectEvidence(TripCause::kDeadlinesOftenMissed, in, 16.0, 16.0, 0);
  in.control_alive_ns = in.due_ns - 41 * kMs;
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kControlHeartbeatLost)) << "an old report";
}

TEST(SafetyMonitor, ExchangesThatFailOrAreSlowInTheWindowTripAndNameTheBus) {
  SafetyInputs in = Fine();
  in.drive.failed_in_window = 16;
  in.drive.slow_in_window = 17;
  EXPECT_EQ(PresentIn(in), 0u);
  in.drive.failed_in_window = 17;
  in.troubles.unreliable = {.bus = 2, .fault = {.kind = 1, .node = 3, .code = 0}};
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kBusUnreliable));
  ExpectEvidence(TripCause::kBusUnreliable, in, 17.0, 17.0, 2);
  EXPECT_EQ(
      FaultFromBits(SafetyMonitor(kLimits).EvidenceOf(TripCause::kBusUnreliable, in).detail).node,
      3);
  in.drive.failed_in_window = 0;
  in.drive.slow_in_window = 18;
  in.troubles.slow = {.bus = 3, .fault = {}};
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kBusTooSlow));
  ExpectEvidence(TripCause::kBusTooSlow, in, 18.0, 18.0, 3);
}

TEST(SafetyMonitor, LateThreadsOfASimulatedArmAreCountedAndDoNotTrip) {
  MonitorLimits limits = kLimits;
  limits.late_threads_trip = false;
  SafetyMonitor monitor(limits);
  SafetyInputs in = Fine();
  in.permit_age_ns = 100 * kMs;
  in.control.missed_in_a_row = 3;
  in.control.missed_in_window = 16;
  EXPECT_EQ(monitor.Judge(in).present, 0u);
  EXPECT_EQ(monitor.Judge(in).present, 0u);
  EXPECT_EQ(monitor.timing(), (TimingCounts{.safety_overruns = 2,
                                            .oldest_permit_ns = 100 * kMs,
                                            .deadlines_missed = 1,
                                            .deadlines_often_missed = 1}));
  in.drive.bus_ok = false;
  EXPECT_EQ(monitor.Judge(in).present, CauseBit(TripCause::kBusLost)) << "everything else trips";
}

TEST(SafetyMonitor, AShutdownWithPowerLeftTripsAfterItsLimit) {
  constexpr std::int64_t kLimitNs = kLimits.stop_timeout_ns + SafetyMonitor::kShutdownMarginNs;
  SafetyMonitor monitor(kLimits);
  SafetyInputs in = Fine();
  const auto present_after = [&](std::int64_t after_ns) {
    in.due_ns = Fine().due_ns + after_ns;
    in.control_alive_ns = in.drive_alive_ns = in.due_ns - kMs;
    return monitor.Judge(in).present;
  };
  EXPECT_EQ(present_after(0), 0u);
  in.shutting_down = true;
  EXPECT_EQ(present_after(1'000 * kMs), 0u) << "it begins here";
  EXPECT_EQ(present_after(1'000 * kMs + kLimitNs), 0u);
  EXPECT_EQ(present_after(1'001 * kMs + kLimitNs), CauseBit(TripCause::kShutdownTimeout));
  const Evidence evidence = monitor.EvidenceOf(TripCause::kShutdownTimeout, in);
  EXPECT_DOUBLE_EQ(evidence.value, 3.501);
  EXPECT_DOUBLE_EQ(evidence.limit, 3.5);
  EXPECT_EQ(evidence.channel, 0u);
  for (const SafetyState state : {kArmed, kRunning, kStopping, kFaultStopping, kDisarming}) {
    in.state = state;
    EXPECT_NE(present_after(1'002 * kMs + kLimitNs) & CauseBit(TripCause::kShutdownTimeout), 0u);
  }
  for (const SafetyState state : {kStarting, kIdle, kTripped}) {
    in.state = state;
    EXPECT_EQ(present_after(1'003 * kMs + kLimitNs), 0u) << "the relay is open";
  }
}

TEST(SafetyMonitor, FaultsOfTheLoopCountWhileItIsAlive) {
  SafetyInputs in = Fine();
  in.control.faults = CauseBit(TripCause::kHubRate2) | CauseBit(TripCause::kEstimatorResidual);
  in.control.evidence = {.value = 10.5, .limit = 10.0, .channel = 2, .detail = 0};
  EXPECT_EQ(PresentIn(in), in.control.faults);
  ExpectEvidence(TripCause::kHubRate2, in, 10.5, 10.0, 2);
  in.control_alive_ns = in.due_ns - 41 * kMs;
  EXPECT_EQ(PresentIn(in), CauseBit(TripCause::kControlHeartbeatLost))
      << "an old report does not count: only the lost heartbeat does";
}

TEST(SafetyMonitor, ATaskThatHasNotReportedYetGivesNoCause) {
  SafetyMonitor supervisor(kLimits);
  SafetyInputs in = Fine();
  in.state = kStarting;
  in.control = kNoControlReport;
  in.control_alive_ns = INT64_MIN;
  in.drive = kNoDriveReport;
  in.drive_alive_ns = INT64_MIN;
  SafetyFacts facts = supervisor.Judge(in);
  EXPECT_EQ(facts.present, 0u);
  EXPECT_EQ(facts.all_reported, 0);

  in.drive = Fine().drive;
  in.drive_alive_ns = Fine().drive_alive_ns;
  facts = supervisor.Judge(in);
  EXPECT_EQ(facts.present, 0u);
  EXPECT_EQ(facts.all_reported, 0) << "the control task is still missing";

  in.levels &= ~LineBit(Line::kEmergencyStop);
  EXPECT_EQ(supervisor.Judge(in).present, CauseBit(TripCause::kEmergencyStop))
      << "the lines count from the first tick on";

  facts = supervisor.Judge(Fine());
  EXPECT_EQ(facts.all_reported, 1);
}

TEST(SafetyMonitor, RestCountsOnlyFromALoopThatIsAlive) {
  SafetyMonitor supervisor(kLimits);
  SafetyInputs in = Fine();
  in.control.at_rest = true;
  EXPECT_EQ(supervisor.Judge(in).at_rest, 1);
  in.control_alive_ns = in.due_ns - 41 * kMs;
  EXPECT_EQ(supervisor.Judge(in).at_rest, 0);
}

TEST(SafetyMonitor, StoppingDoesNotEndOnAReportFromBeforeIt) {
  SafetyMonitor supervisor(kLimits);
  SafetyInputs in = Fine();
  in.state = kStopping;
  in.control.at_rest = true;
  in.state_since_ns = in.control.due_ns;
  EXPECT_EQ(supervisor.Judge(in).at_rest, 0);
  in.state_since_ns = in.control.due_ns - 1;
  EXPECT_EQ(supervisor.Judge(in).at_rest, 1);
}

TEST(SafetyMonitor, TheEndOfTheLastExperimentDoesNotEndTheNext) {
  SafetyMonitor supervisor(kLimits);
  SafetyInputs in = Fine();
  in.control.experiment_done = true;
  EXPECT_EQ(supervisor.Judge(in).experiment_done, 1);
  in.running_since_ns = in.control.due_ns;  // the step may be from before the run
  EXPECT_EQ(supervisor.Judge(in).experiment_done, 0);
  in.running_since_ns = INT64_MIN;
  in.state = kArmed;
  EXPECT_EQ(supervisor.Judge(in).experiment_done, 0);
}

TEST(SafetyMonitor, StopExpiresAfterItsTimeInStoppingOnly) {
  SafetyMonitor supervisor(kLimits);
  SafetyInputs in = Fine();
  in.state = kStopping;
  in.state_since_ns = in.due_ns - 3000 * kMs;
  EXPECT_EQ(supervisor.Judge(in).stop_expired, 0);
  in.state_since_ns = in.due_ns - 3001 * kMs;
  EXPECT_EQ(supervisor.Judge(in).stop_expired, 1);
  ExpectEvidence(TripCause::kStopTimeout, in, 3.001, 3.0, 0);
  in.state = kRunning;
  EXPECT_EQ(supervisor.Judge(in).stop_expired, 0);
}

TEST(SafetyMonitor, TheResetButtonCountsWhenPressedAfterTheTrip) {
  SafetyMonitor supervisor(kLimits);
  SafetyInputs up = Fine();
  SafetyInputs down = Fine();
  down.levels |= LineBit(Line::kResetButton);

  EXPECT_EQ(supervisor.Judge(down).reset_pressed, 0) << "down from the start, and no trip";
  supervisor.Judge(up);
  EXPECT_EQ(supervisor.Judge(down).reset_pressed, 0) << "pressed before the trip";
  up.state = down.state = kTripped;
  EXPECT_EQ(supervisor.Judge(down).reset_pressed, 0) << "still held from before the trip";
  EXPECT_EQ(supervisor.Judge(up).reset_pressed, 0);
  EXPECT_EQ(supervisor.Judge(down).reset_pressed, 1);
  EXPECT_EQ(supervisor.Judge(up).reset_pressed, 1) << "it may be released before the operator asks";

  up.state = kIdle;
  EXPECT_EQ(supervisor.Judge(up).reset_pressed, 0);
  up.state = kTripped;
  EXPECT_EQ(supervisor.Judge(up).reset_pressed, 0) << "the next trip needs a new press";
}

TEST(SafetyMonitor, AButtonThatIsStuckFromTheStartNeverCounts) {
  SafetyMonitor supervisor(kLimits);
  SafetyInputs in = Fine();
  in.state = kTripped;
  in.levels |= LineBit(Line::kResetButton);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(supervisor.Judge(in).reset_pressed, 0);
}

TEST(SafetyMonitor, TakesItsLimitsFromTheConfiguration) {
  SafetyConfig safety{};
  safety.stop_timeout_s = 3.0;
  safety.fault_stop_s = 1.375;
  safety.homing_contact_s = 0.625;
  safety.permit_timeout_ms = 5.25;
  safety.missed_deadlines_to_trip = 5;
  safety.overrun_to_trip_ms = 4.5;
  safety.missed_deadlines_in_window = 6;
  safety.failed_exchanges_in_window = 7;
  safety.slow_exchanges_in_window = 8;
  const LoopConfig loop{.period_ms = 20.0,
                        .acquire_before_ms = 5.0,
                        .step_deadline_ms = 5.0,
                        .output = OutputTiming::kNextTick,
                        .output_after_ms = 15.0,
                        .actuation_delay_ms = 0.0};
  const MonitorLimits limits = MakeMonitorLimits(safety, loop, true);
  EXPECT_EQ(limits.heartbeat_timeout_ns, 40 * kMs);
  EXPECT_EQ(limits.stop_timeout_ns, 3000 * kMs);
  EXPECT_EQ(limits.fault_stop_ns, 1375 * kMs);
  EXPECT_EQ(limits.homing_contact_ns, 625 * kMs);
  EXPECT_EQ(limits.lines_stall_ns, 5'250'000) << "the permit's timeout, 5.25 ms";
  EXPECT_EQ(limits.missed_deadlines_to_trip, 5);
  EXPECT_EQ(limits.overrun_ns, 4'500'000);
  EXPECT_EQ(limits.missed_in_window, 6);
  EXPECT_EQ(limits.failed_in_window, 7);
  EXPECT_EQ(limits.slow_in_window, 8);
  EXPECT_TRUE(limits.late_threads_trip);
  EXPECT_FALSE(MakeMonitorLimits(safety, loop, false).late_threads_trip);
  EXPECT_FALSE(limits.power.witness());
  const DriveVoltageTimes times{.rise_ms = 300.0, .fall_ms = 2000.0};
  const PowerPathLimits power = MakeMonitorLimits(safety, loop, true, times).power;
  EXPECT_EQ(power.rise_ns, 300 * kMs);
  EXPECT_EQ(power.fall_ns, 2000 * kMs);
  EXPECT_EQ(power.report_ns, 60 * kMs) << "three periods";
}

TEST(SafetyMonitor, MayDampNeedsGoodSensorsAndEveryDriveOn) {
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(Fine()).may_damp, 1);
  SafetyInputs in = Fine();
  in.control.may_damp = false;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).may_damp, 0);
  in = Fine();
  in.control_alive_ns = in.due_ns - 41 * kMs;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).may_damp, 0) << "an old report";
  MonitorLimits without = kLimits;
  without.fault_stop_ns = 0;
  EXPECT_EQ(SafetyMonitor(without).Judge(Fine()).may_damp, 0);
  without.fault_stop_ns = 1;
  EXPECT_EQ(SafetyMonitor(without).Judge(Fine()).may_damp, 1) << "any time is one";
  for (const DrivePower power : {DrivePower::kNone, DrivePower::kOff, DrivePower::kMixed}) {
    in = Fine();
    in.drive.power = power;
    EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).may_damp, 0);
  }
}

TEST(SafetyMonitor, ACauseBeyondThoseOfItsBeginningEndsDamping) {
  SafetyMonitor monitor(kLimits);
  SafetyInputs in = Fine();
  const auto next = [&](TripCauses causes) {
    in.due_ns += kMs;
    in.control.faults = causes;
    in.control.due_ns = in.control_alive_ns = in.drive.due_ns = in.drive_alive_ns = in.due_ns;
    return monitor.Judge(in).may_damp;
  };
  constexpr TripCauses kBegan = CauseBit(TripCause::kSoftLimit1) | CauseBit(TripCause::kHubRate1);
  EXPECT_EQ(next(kBegan), 1);
  in.state = kFaultStopping;
  in.state_since_ns = in.due_ns;
  EXPECT_EQ(next(kBegan), 1);
  EXPECT_EQ(next(0), 1);
  EXPECT_EQ(next(CauseBit(TripCause::kHubRate1)), 1) << "it was there at the beginning";
  EXPECT_EQ(next(kBegan | CauseBit(TripCause::kBendingStrain2)), 0);

  in.state = SafetyState::kRunning;
  EXPECT_EQ(next(CauseBit(TripCause::kBendingStrain2)), 1);
  in.state = kFaultStopping;
  EXPECT_EQ(next(CauseBit(TripCause::kBendingStrain2)), 1) << "the beginning of another stop";
}

TEST(SafetyMonitor, FaultStoppingAndDisarmingHaveTheirOwnTimeLimits) {
  for (const auto& [state, limit_ns] : {std::pair{kFaultStopping, kLimits.fault_stop_ns},
                                        std::pair{kDisarming, SafetyMonitor::kDisarmNs}}) {
    SafetyInputs in = Fine();
    in.state = state;
    in.state_since_ns = in.due_ns - limit_ns;
    EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).stop_expired, 0) << ToString(state);
    in.state_since_ns -= 1;
    EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).stop_expired, 1) << ToString(state);
  }
}

TEST(SafetyMonitor, DrivesAreOffOnlyByAReportOfThisState) {
  SafetyInputs in = Fine();
  in.state = kDisarming;
  in.drive.power = DrivePower::kOff;
  in.state_since_ns = in.drive.due_ns;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).drives_off, 0) << "it is from before";
  in.state_since_ns -= 1;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).drives_off, 1);
  in.drive.power = DrivePower::kMixed;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).drives_off, 0);
}

}  // namespace
}  // namespace flexarm
