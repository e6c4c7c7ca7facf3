#include <gtest/gtest.h>

#include "controller/safety/line_filter.h"
#include "controller/safety/safety_monitor.h"
#include "tests/controller/safety/monitored_arm.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using enum SafetyState;

TEST(SafetyMonitor, LinesThatAreNotKnownYetAreNoCauseAndNoReport) {
  SafetyInputs in = Fine();
  in.levels = 0;
  in.levels_known = false;
  const SafetyFacts facts = SafetyMonitor(kLimits).Judge(in);
  EXPECT_EQ(facts.present, 0u);
  EXPECT_EQ(facts.all_reported, 0);
}

TEST(SafetyMonitor, EachTaskIsWaitedForAndOnceIsEnough) {
  SafetyInputs without_drives = Fine();
  without_drives.drive = kNoDriveReport;
  SafetyInputs without_loop = Fine();
  without_loop.control = kNoControlReport;
  for (const SafetyInputs& in : {without_drives, without_loop}) {
    SafetyMonitor monitor(kLimits);
    EXPECT_EQ(monitor.Judge(in).all_reported, 0);
    EXPECT_EQ(monitor.Judge(Fine()).all_reported, 1);
    EXPECT_EQ(monitor.Judge(in).all_reported, 1);
  }
}

TEST(SafetyMonitor, TheFirstTickOfTheLoopIsAReport) {
  SafetyInputs in = Fine();
  in.control.tick = 0;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).all_reported, 1);
}

// The three witnesses of the safety lines; a failed call is named before the others.
TEST(SafetyMonitor, LinesThatFailAreACauseWithTheEvidenceOfTheWitness) {
  const auto channel_of = [](const SafetyMonitor& monitor, const SafetyInputs& in) {
    return static_cast<LineTrouble>(monitor.EvidenceOf(TripCause::kSafetyLines, in).channel);
  };
  SafetyMonitor monitor(kLimits);
  SafetyInputs in = Fine();
  in.line_calls.read.ok = false;
  EXPECT_EQ(monitor.Judge(in).present, CauseBit(TripCause::kSafetyLines));
  EXPECT_EQ(channel_of(monitor, in), LineTrouble::kReadFailed);

  in = Fine();
  in.relay = RelayContact::kOpen;  // it was told to close: the arm is running
  EXPECT_EQ(monitor.Judge(in).present, 0u) << "it has just begun";
  in.due_ns += RelayContactMonitor::kFollowNs + 1;
  in.control_alive_ns = in.drive_alive_ns = in.due_ns;
  EXPECT_EQ(monitor.Judge(in).present, CauseBit(TripCause::kSafetyLines));
  EXPECT_EQ(channel_of(monitor, in), LineTrouble::kRelayStuckOpen);
  in.line_calls.write.ok = false;
  EXPECT_EQ(monitor.Judge(in).present, CauseBit(TripCause::kSafetyLines));
  EXPECT_EQ(channel_of(monitor, in), LineTrouble::kWriteFailed);
}

TEST(SafetyMonitor, TheVoltageOfTheDrivesIsAWitnessWhereARigHasIt) {
  MonitorLimits limits = kLimits;
  limits.power = {.rise_ns = 300 * kMs, .fall_ns = 2000 * kMs, .report_ns = 60 * kMs};
  SafetyMonitor monitor(limits);
  SafetyInputs in = Fine();
  in.drive.voltage = {.on = PowerPathMonitor::kEveryDrive, .off = 0};
  SafetyFacts facts = monitor.Judge(in);
  EXPECT_EQ(facts.tests_power, 1);
  EXPECT_EQ(facts.power_follows, 1);
  in.drive.voltage = {.on = 0, .off = PowerPathMonitor::kEveryDrive};
  in.due_ns += 1;
  facts = monitor.Judge(in);
  EXPECT_EQ(facts.power_follows, 0);
  EXPECT_EQ(facts.present, 0u);
  in.due_ns = Fine().due_ns + 361 * kMs;  // rise and report: 360 ms
  in.control_alive_ns = in.drive_alive_ns = in.due_ns;
  EXPECT_EQ(monitor.Judge(in).present, CauseBit(TripCause::kSafetyLines));
  const Evidence evidence = monitor.EvidenceOf(TripCause::kSafetyLines, in);
  EXPECT_EQ(static_cast<LineTrouble>(evidence.channel), LineTrouble::kVoltageMissing);
  EXPECT_DOUBLE_EQ(evidence.value, 0.361);
  EXPECT_DOUBLE_EQ(evidence.limit, 0.360);
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).tests_power, 0) << "no limits: no witness";
}

// An arm that is being armed, its pump alone: the report must be as old as the limits say.
TEST(SafetyMonitor, TheVoltageIsJudgedByTheStateAndItsReport) {
  MonitorLimits limits = kLimits;
  limits.power = {.rise_ns = 300 * kMs, .fall_ns = 2000 * kMs, .report_ns = 60 * kMs};
  SafetyInputs in = Fine();
  in.state = kTestingPump;
  in.drive.voltage = {.on = 0, .off = PowerPathMonitor::kEveryDrive};
  in.state_since_ns = in.drive.due_ns - 300 * kMs;
  EXPECT_EQ(SafetyMonitor(limits).Judge(in).power_follows, 1);
  in.state_since_ns += 1;
  EXPECT_EQ(SafetyMonitor(limits).Judge(in).power_follows, 0) << "the voltage may still rise";
}

TEST(SafetyMonitor, ARelayThatDoesNotFollowIsNoReasonToArm) {
  SafetyInputs in = Fine();
  in.state = kIdle;
  in.relay = RelayContact::kOpen;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).power_follows, 1);
  in.relay = RelayContact::kClosed;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).power_follows, 0);
  in.state = kArmed;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).power_follows, 1);
}

TEST(SafetyMonitor, PassesOnTheRequestTheShutdownAndDrivesThatAreOn) {
  SafetyInputs in = Fine();
  SafetyFacts facts = SafetyMonitor(kLimits).Judge(in);
  EXPECT_EQ(facts.request, RequestKind::kNone);
  EXPECT_EQ(facts.shutting_down, 0);
  EXPECT_EQ(facts.drives_on, 1);
  EXPECT_EQ(facts.drives_off, 0);
  in.request = RequestKind::kRun;
  in.shutting_down = true;
  in.drive.power = DrivePower::kMixed;
  facts = SafetyMonitor(kLimits).Judge(in);
  EXPECT_EQ(facts.request, RequestKind::kRun);
  EXPECT_EQ(facts.shutting_down, 1);
  EXPECT_EQ(facts.drives_on, 0);
}

TEST(SafetyMonitor, FaultStoppingDoesNotEndOnAReportFromBeforeIt) {
  SafetyInputs in = Fine();
  in.state = kFaultStopping;
  in.control.at_rest = true;
  in.state_since_ns = in.control.due_ns;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).at_rest, 0);
  in.state_since_ns -= 1;
  EXPECT_EQ(SafetyMonitor(kLimits).Judge(in).at_rest, 1);
}

TEST(SafetyMonitor, APressThatBeganBeforeTheTripIsNoAnswerToIt) {
  SafetyInputs up = Fine();
  up.state = kTripped;
  up.state_since_ns = up.due_ns - LineFilter::kPressNs;
  SafetyInputs down = up;
  down.levels |= LineBit(Line::kResetButton);
  SafetyMonitor monitor(kLimits);
  monitor.Judge(up);
  down.state_since_ns += 1;
  EXPECT_EQ(monitor.Judge(down).reset_pressed, 0);
  monitor.Judge(up);
  down.state_since_ns -= 1;
  EXPECT_EQ(monitor.Judge(down).reset_pressed, 1);
}

TEST(SafetyMonitor, TheOldestPermitIsKeptAndTheSameLatenessCountsOnce) {
  SafetyMonitor monitor(kLimits);
  SafetyInputs in = Fine();
  in.permit_age_ns = 4 * kMs;
  monitor.Judge(in);
  in.permit_age_ns = 2 * kMs;
  in.control.missed_in_a_row = 2;
  in.control.missed_in_window = 15;
  monitor.Judge(in);
  EXPECT_EQ(monitor.timing(), TimingCounts{.oldest_permit_ns = 4 * kMs});
  for (int begins = 1; begins <= 2; ++begins) {
    in.control.missed_in_a_row = 3;
    in.control.missed_in_window = 16;
    for (int i = 0; i < 3; ++i) monitor.Judge(in);
    EXPECT_EQ(monitor.timing().deadlines_missed, static_cast<std::uint32_t>(begins));
    EXPECT_EQ(monitor.timing().deadlines_often_missed, static_cast<std::uint32_t>(begins));
    in.control.missed_in_a_row = in.control.missed_in_window = 0;
    monitor.Judge(in);
  }
}

TEST(SafetyMonitor, TheEvidenceOfADriveFaultAndOfACauseWithoutAny) {
  SafetyInputs in = Fine();
  in.drive.drive_ok = false;
  in.troubles.drive.bus = 2;
  ExpectEvidence(TripCause::kDriveFault, in, 0.0, 1.0, 2);
  in.control.evidence = {.value = 5.0, .limit = 6.0, .channel = 7, .detail = 8};  // of no fault
  ExpectEvidence(TripCause::kStateNotFinite, in, 0.0, 0.0, 0);
  EXPECT_EQ(SafetyMonitor(kLimits).EvidenceOf(TripCause::kStateNotFinite, in).detail, 0u);
  ExpectEvidence(TripCause::kLimitSwitch1Low, in, 0.0, 0.0, 0);  // it has closed again
}

}  // namespace
}  // namespace flexarm
