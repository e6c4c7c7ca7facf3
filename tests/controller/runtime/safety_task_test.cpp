#include "controller/runtime/safety_task.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "controller/runtime/lockstep_executor.h"
#include "controller/safety/gate.h"

// The safety task between a control and a drive side that can be stopped, on the lock-step clock.

namespace flexarm {
namespace {

using enum SafetyState;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriodNs = 20 * kMs;
constexpr std::int64_t kPhaseNs = 5 * kMs;
constexpr std::int64_t kDeadlineNs = 10 * kMs;
constexpr SupervisorLimits kLimits{.heartbeat_timeout_ns = 2 * kPeriodNs,
                                   .stop_timeout_ns = 3000 * kMs,
                                   .missed_deadlines_to_trip = 3};

struct FakeLines final : SafetyLines {
  struct Written {
    std::int64_t now_ns;
    Outputs outputs;
  };

  LineLevels Read(std::int64_t) noexcept override { return levels; }
  void Write(std::int64_t now_ns, const Outputs& outputs) noexcept override {
    written.push_back({now_ns, outputs});
  }
  bool relay_closed() const { return written.back().outputs.relay_closed; }

  LineLevels levels = kHealthyLevels;
  std::vector<Written> written;
};

struct FakeControl final : Task {
  explicit FakeControl(ControlReportChannel* out) : out_(out) {}
  Traits traits() const noexcept override {
    return {.name = "control",
            .period_ns = kPeriodNs,
            .phase_ns = kPhaseNs,
            .deadline_ns = kDeadlineNs,
            .priority = 80};
  }
  void Run(const Activation& activation) noexcept override {
    if (stopped) return;
    report.tick = (activation.due_ns - kPhaseNs) / kPeriodNs;
    report.due_ns = activation.due_ns;
    history_.Push(activation.due_ns + kDeadlineNs, report);
    out_->Publish(history_);
  }

  bool stopped = false;
  ControlReport report = [] {
    ControlReport initial = kNoControlReport;
    initial.at_rest = true;
    return initial;
  }();

 private:
  ControlReportHistory history_{kNoControlReport};
  ControlReportChannel* out_;
};

// Writes the torque that the gate lets through, like the plant task.
struct FakeDrive final : Task {
  FakeDrive(PermitChannel* permits, DriveReportChannel* out) : permits_(permits), out_(out) {}
  Traits traits() const noexcept override {
    return {.name = "drive", .period_ns = kMs, .phase_ns = 0, .deadline_ns = kMs, .priority = 60};
  }
  void Run(const Activation& activation) noexcept override {
    if (stopped) return;
    const Permit& permit = permits_->Read().At(activation.due_ns - 1).value;
    const GateLimits limits{.torque_nm = {30.0, 6.0},
                            .slew_nm_per_s = {500.0, 150.0},
                            .command_timeout_ns = 2 * kPeriodNs,
                            .permit_timeout_ns = 5 * kMs};
    const GateResult result = Gate({.asked_nm = {1.0, 1.0},
                                    .asked_age_ns = 0,  // commands never age: the permit alone acts
                                    .permit = permit.state,
                                    .permit_age_ns = AgeNs(activation.due_ns, permit.renewed_ns),
                                    .previous_nm = torque_nm,
                                    .dt_s = 1e-3},
                                   limits);
    torque_nm = result.torque_nm;
    report.due_ns = activation.due_ns;
    history_.Push(activation.due_ns + kMs, report);
    out_->Publish(history_);
  }

  bool stopped = false;
  std::array<double, 2> torque_nm{};
  DriveReport report{.due_ns = INT64_MIN, .bus_ok = true, .drive_ok = true};

 private:
  DriveReportHistory history_{kNoDriveReport};
  PermitChannel* permits_;
  DriveReportChannel* out_;
};

class SafetyTaskTest : public testing::Test {
 protected:
  SafetyTaskTest() {
    executor_.Add(drive_);
    executor_.Add(control_);
    executor_.Add(safety_);
  }

  void RunFor(std::int64_t duration_ns) { executor_.RunUntil(executor_.next_ns() + duration_ns); }

  std::uint32_t Ask(RequestKind kind, std::int64_t not_before_ns = INT64_MIN) {
    EXPECT_TRUE(
        requests_.Push({.kind = kind, .number = ++number_, .not_before_ns = not_before_ns}));
    return number_;
  }

  // Asks, runs one tick, and gives the answer.
  Refusal Now(RequestKind kind) {
    const std::uint32_t number = Ask(kind);
    RunFor(kMs);
    RequestAnswer answer{};
    while (answers_.Pop(&answer)) {
      if (answer.number == number) return answer.refusal;
    }
    ADD_FAILURE() << "no answer to " << Name(kind);
    return Refusal::kNone;
  }

  void GoTo(SafetyState state) {
    RunFor(100 * kMs);
    ASSERT_EQ(safety_.status().state, kIdle);
    if (state == kIdle) return;
    ASSERT_EQ(Now(RequestKind::kArm), Refusal::kNone);
    if (state == kArmed) return;
    ASSERT_EQ(Now(RequestKind::kRun), Refusal::kNone);
    control_.report.at_rest = false;
    RunFor(200 * kMs);
    ASSERT_EQ(safety_.status().state, kRunning);
    ASSERT_EQ(drive_.torque_nm[0], 1.0);
  }

  // Runs till the trip; gives its instant.
  std::int64_t RunUntilTripped(std::int64_t at_most_ns) {
    const std::int64_t end_ns = executor_.next_ns() + at_most_ns;
    while (safety_.status().state != kTripped && executor_.next_ns() < end_ns) RunFor(kMs);
    EXPECT_EQ(safety_.status().state, kTripped);
    return executor_.next_ns() - kMs;
  }

  std::vector<SafetyRecord> Records() {
    SafetyRecord record{};
    while (records_.Pop(&record)) all_records_.push_back(record);
    return all_records_;
  }

  const Permit& permit() { return operator_permits_.Read().Newest().value; }

  FakeLines lines_;
  ControlReportChannel reports_{ControlReportHistory(kNoControlReport)};
  DriveReportChannel drive_reports_{DriveReportHistory(kNoDriveReport)};
  PermitChannel drive_permits_{PermitHistory(kNoPermit)};
  PermitChannel operator_permits_{PermitHistory(kNoPermit)};
  SpscQueue<OperatorRequest> requests_{100};
  SpscQueue<RequestAnswer> answers_{100};
  SpscQueue<SafetyRecord> records_{10'000};
  SafetyTask safety_{kLimits,
                     {.lines = &lines_,
                      .control = &reports_,
                      .drives = {&drive_reports_},
                      .requests = &requests_,
                      .permits = {&drive_permits_, &operator_permits_},
                      .answers = &answers_,
                      .records = &records_}};
  FakeControl control_{&reports_};
  FakeDrive drive_{&drive_permits_, &drive_reports_};
  LockstepExecutor executor_;
  std::uint32_t number_ = 0;
  std::vector<SafetyRecord> all_records_;
};

TEST_F(SafetyTaskTest, ComesToIdleWhenEveryTaskHasReportedAndStaysThere) {
  RunFor(15 * kMs);  // the first step's report holds from 5 + 10 ms on
  EXPECT_EQ(safety_.status().state, kStarting);
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kIdle);
  RunFor(2000 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle) << "nothing arms by itself";
  for (const auto& written : lines_.written) {
    EXPECT_FALSE(written.outputs.relay_closed);
    EXPECT_FALSE(written.outputs.pump_level);
  }
}

TEST_F(SafetyTaskTest, StaysInStartingWithoutADriveSide) {
  drive_.stopped = true;
  RunFor(1000 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kStarting, TripCause::kNone}));
}

TEST_F(SafetyTaskTest, ThePumpTogglesEveryTickWhileTheRelayIsClosedAndOnlyThen) {
  GoTo(kRunning);
  lines_.written.clear();
  RunFor(10 * kMs);
  ASSERT_EQ(lines_.written.size(), 10u);
  for (std::size_t i = 1; i < lines_.written.size(); ++i) {
    EXPECT_TRUE(lines_.written[i].outputs.relay_closed);
    EXPECT_NE(lines_.written[i].outputs.pump_level, lines_.written[i - 1].outputs.pump_level);
  }
  lines_.levels &= ~LineBit(Line::kEmergencyStop);
  lines_.written.clear();
  RunFor(10 * kMs);
  for (const auto& written : lines_.written) {
    EXPECT_FALSE(written.outputs.relay_closed);
    EXPECT_FALSE(written.outputs.pump_level);
  }
}

TEST_F(SafetyTaskTest, EverySwitchOpensTheRelayAtTheNextTickAndZeroesTheTorqueWithinTwoMs) {
  const struct {
    Line line;
    TripCause cause;
  } cases[] = {{Line::kLimit1Low, TripCause::kLimitSwitch1Low},
               {Line::kLimit1High, TripCause::kLimitSwitch1High},
               {Line::kLimit2Low, TripCause::kLimitSwitch2Low},
               {Line::kLimit2High, TripCause::kLimitSwitch2High},
               {Line::kEmergencyStop, TripCause::kEmergencyStop}};
  bool first = true;
  for (const auto& c : cases) {
    SCOPED_TRACE(Name(c.cause));
    if (first) {
      GoTo(kRunning);
      first = false;
    } else {  // out of the last trip
      lines_.levels = kHealthyLevels | LineBit(Line::kResetButton);
      control_.report.at_rest = true;
      RunFor(100 * kMs);
      lines_.levels = kHealthyLevels;
      RunFor(kMs);
      ASSERT_EQ(Now(RequestKind::kReset), Refusal::kNone);
      GoTo(kRunning);
    }
    const std::int64_t opened_ns = executor_.next_ns();
    lines_.levels &= ~LineBit(c.line);
    RunFor(kMs);  // the tick at which the level is open
    EXPECT_EQ(lines_.written.back().now_ns, opened_ns);
    EXPECT_FALSE(lines_.relay_closed());
    EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, c.cause}));
    RunFor(kMs);  // the drive's next
    EXPECT_EQ(drive_.torque_nm[0], 0.0);
    EXPECT_EQ(drive_.torque_nm[1], 0.0);
    EXPECT_EQ(permit().cause, c.cause);
    EXPECT_EQ(permit().evidence.limit, 1.0);
    lines_.levels |= LineBit(c.line);
    RunFor(1000 * kMs);
    EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, c.cause})) << "latched, though it closed";
  }
}

// Stopped at each ms of a period: whenever it is, torque ends within two periods and 2 ms.
TEST_F(SafetyTaskTest, AStoppedControlThreadEndsTheTorqueWithinTwoPeriodsAndTwoMs) {
  GoTo(kRunning);
  for (int offset_ms = 0; offset_ms < 20; ++offset_ms) {
    SCOPED_TRACE(offset_ms);
    RunFor(kPeriodNs + kMs);
    ASSERT_EQ(drive_.torque_nm[0], 1.0);
    // Nothing that is due at next_ns() or later runs any more: it stopped just before.
    const std::int64_t stopped_ns = executor_.next_ns();
    control_.stopped = true;
    const std::int64_t tripped_ns = RunUntilTripped(1000 * kMs);
    EXPECT_EQ(safety_.status().cause, TripCause::kControlHeartbeatLost);
    EXPECT_GT(permit().evidence.value, 0.040);
    EXPECT_EQ(permit().evidence.limit, 0.040);
    RunFor(kMs);
    EXPECT_EQ(drive_.torque_nm[0], 0.0) << "at the drive's tick after the trip";
    EXPECT_LE(tripped_ns + kMs, stopped_ns + 2 * kPeriodNs + 2 * kMs);

    control_.stopped = false;
    control_.report.at_rest = true;
    lines_.levels |= LineBit(Line::kResetButton);
    RunFor(100 * kMs);
    lines_.levels = kHealthyLevels;
    ASSERT_EQ(safety_.status().state, kTripped) << "it runs again, and nothing re-arms";
    ASSERT_EQ(Now(RequestKind::kReset), Refusal::kNone);
    GoTo(kRunning);
    // Move on by one ms a round.
    while ((executor_.next_ns() / kMs) % 20 != offset_ms) RunFor(kMs);
  }
}

TEST_F(SafetyTaskTest, OneSkippedPeriodOfTheControlThreadIsNotAStoppedOne) {
  GoTo(kRunning);
  while (executor_.next_ns() % kPeriodNs != kPhaseNs) RunFor(kMs);
  control_.stopped = true;
  RunFor(kMs);
  control_.stopped = false;
  RunFor(200 * kMs);
  EXPECT_EQ(safety_.status().state, kRunning);
}

TEST_F(SafetyTaskTest, AFrozenDriveSideTripsAsAStaleFrameWithinTwoPeriodsAndTwoMs) {
  GoTo(kRunning);
  const std::int64_t frozen_ns = executor_.next_ns();
  drive_.stopped = true;
  const std::int64_t tripped_ns = RunUntilTripped(1000 * kMs);
  EXPECT_LE(tripped_ns, frozen_ns + 2 * kPeriodNs + 2 * kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kStaleFrame);
  EXPECT_FALSE(lines_.relay_closed());
  drive_.stopped = false;
  RunFor(2 * kMs);
  EXPECT_EQ(drive_.torque_nm[0], 0.0) << "it wakes into a trip";
  RunFor(1000 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kStaleFrame}));
}

TEST_F(SafetyTaskTest, ALostBusAndADriveFaultTripAtTheTickFromWhichTheReportHolds) {
  GoTo(kRunning);
  drive_.report.drive_ok = false;
  const std::int64_t reported_ns = executor_.next_ns();
  EXPECT_EQ(RunUntilTripped(10 * kMs), reported_ns + kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kDriveFault);
  drive_.report.bus_ok = false;
  RunFor(10 * kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kDriveFault) << "the first cause stays";
}

TEST_F(SafetyTaskTest, AFaultOfTheLoopTripsWhenItsReportHoldsAndBringsItsEvidence) {
  GoTo(kRunning);
  control_.report.faults =
      CauseBit(TripCause::kSoftLimit2) | CauseBit(TripCause::kEstimatorResidual);
  control_.report.evidence = {.value = 1.6, .limit = 1.57, .channel = 2, .reserved = 0};
  const std::int64_t tripped_ns = RunUntilTripped(100 * kMs);
  EXPECT_EQ((tripped_ns - kPhaseNs) % kPeriodNs, kDeadlineNs);
  EXPECT_EQ(permit().cause, TripCause::kSoftLimit2);
  EXPECT_EQ(permit().evidence.value, 1.6);
  EXPECT_EQ(permit().evidence.limit, 1.57);
  EXPECT_EQ(permit().evidence.channel, 2u);
}

TEST_F(SafetyTaskTest, TheEndOfTheExperimentStopsDampsAndArms) {
  GoTo(kRunning);
  control_.report.experiment_done = true;
  RunFor(40 * kMs);
  EXPECT_EQ(safety_.status().state, kStopping);
  EXPECT_EQ(drive_.torque_nm[0], 1.0) << "the controller damps the arm";
  control_.report.at_rest = true;
  RunFor(40 * kMs);
  EXPECT_EQ(safety_.status().state, kArmed);
  EXPECT_EQ(drive_.torque_nm[0], 0.0);
  EXPECT_TRUE(lines_.relay_closed());

  ASSERT_EQ(Now(RequestKind::kRun), Refusal::kNone);
  control_.report.experiment_done = false;
  control_.report.at_rest = false;
  RunFor(100 * kMs);
  EXPECT_EQ(safety_.status().state, kRunning) << "the end of the last run does not end this one";
}

TEST_F(SafetyTaskTest, StoppingLongerThanAllowedTripsThreeSecondsAfterTheStop) {
  GoTo(kRunning);
  const std::int64_t stopped_ns = executor_.next_ns();
  ASSERT_EQ(Now(RequestKind::kStop), Refusal::kNone);
  EXPECT_EQ(RunUntilTripped(4000 * kMs), stopped_ns + 3001 * kMs);
  EXPECT_EQ(safety_.status().cause, TripCause::kStopTimeout);
  EXPECT_DOUBLE_EQ(permit().evidence.value, 3.001);
  EXPECT_DOUBLE_EQ(permit().evidence.limit, 3.0);
}

TEST_F(SafetyTaskTest, NothingRearmsByItselfAndResetNeedsButtonAndOperator) {
  GoTo(kRunning);
  lines_.levels &= ~LineBit(Line::kEmergencyStop);
  RunFor(kMs);
  ASSERT_EQ(safety_.status().state, kTripped);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kCauseRemains);
  lines_.levels |= LineBit(Line::kEmergencyStop);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNoReset);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kWrongState);
  lines_.levels |= LineBit(Line::kResetButton);
  RunFor(10 * kMs);
  lines_.levels &= ~LineBit(Line::kResetButton);
  RunFor(10'000 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kEmergencyStop}));
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNotAtRest);
  control_.report.at_rest = true;
  RunFor(40 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNone);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kIdle, TripCause::kNone}));
  EXPECT_EQ(permit().evidence.limit, 0.0);
  RunFor(10'000 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle);
  EXPECT_FALSE(lines_.relay_closed());
}

TEST_F(SafetyTaskTest, PlannedRequestsAreJudgedAtTheirTickInOrder) {
  Ask(RequestKind::kArm, 100 * kMs);
  Ask(RequestKind::kRun, 200 * kMs + 1);  // not on the grid: the next tick
  executor_.RunUntil(100 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle);
  executor_.RunUntil(100 * kMs + 1);
  EXPECT_EQ(safety_.status().state, kArmed);
  executor_.RunUntil(201 * kMs);
  EXPECT_EQ(safety_.status().state, kArmed);
  executor_.RunUntil(201 * kMs + 1);
  EXPECT_EQ(safety_.status().state, kRunning);
  EXPECT_EQ(permit().running_since_ns, 201 * kMs);

  RequestAnswer answer{};
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.kind, RequestKind::kArm);
  EXPECT_EQ(answer.number, 1u);
  EXPECT_EQ(answer.state, kIdle) << "the state in which it was judged";
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.kind, RequestKind::kRun);
  EXPECT_FALSE(answers_.Pop(&answer));
}

TEST_F(SafetyTaskTest, RequestsThatArriveTogetherAreJudgedOneATickInOrder) {
  RunFor(100 * kMs);
  Ask(RequestKind::kArm);
  Ask(RequestKind::kRun);
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kArmed);
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kRunning);
}

TEST_F(SafetyTaskTest, AStopOvertakesPlannedRequestsAndCancelsThePlannedRun) {
  GoTo(kRunning);
  const std::uint32_t planned_run = Ask(RequestKind::kRun, executor_.next_ns() + 500 * kMs);
  Ask(RequestKind::kDisarm, executor_.next_ns() + 1000 * kMs);
  RunFor(kMs);
  Ask(RequestKind::kStop);
  const std::uint32_t later_run = Ask(RequestKind::kRun, executor_.next_ns() + 5000 * kMs);
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kStopping);
  RequestAnswer answer{};
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.kind, RequestKind::kStop);
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.number, planned_run);
  EXPECT_EQ(answer.refusal, Refusal::kCancelled);
  EXPECT_FALSE(answers_.Pop(&answer)) << "the planned disarm stays, and what came after the stop";
  control_.report.at_rest = true;
  RunFor(1000 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle) << "armed at rest, then disarmed as planned";
  lines_.levels = 0;
  RunFor(kMs);
  while (answers_.Pop(&answer)) {
  }
  EXPECT_EQ(answer.number, later_run);
  EXPECT_EQ(answer.refusal, Refusal::kCancelled) << "a trip cancels all";
}

TEST_F(SafetyTaskTest, ThePermitIsRenewedEveryTick) {
  GoTo(kArmed);
  for (int i = 0; i < 5; ++i) {
    const std::int64_t due_ns = executor_.next_ns();
    RunFor(kMs);
    EXPECT_EQ(permit().renewed_ns, due_ns);
    EXPECT_EQ(operator_permits_.Read().Newest().from_ns, due_ns);
  }
}

// What the recorder gets is enough to run the machine again: the same transitions, nothing between.
TEST_F(SafetyTaskTest, TheRecordsReplayToTheSameTransitions) {
  GoTo(kRunning);
  ASSERT_EQ(Now(RequestKind::kDisarm), Refusal::kWrongState);
  ASSERT_EQ(Now(RequestKind::kDisarm), Refusal::kWrongState);  // the same facts twice in a row
  lines_.levels &= ~LineBit(Line::kLimit2High);
  RunFor(100 * kMs);
  const std::vector<SafetyRecord> records = Records();
  ASSERT_GT(records.size(), 8u);
  EXPECT_EQ(records.front().due_ns, 0) << "the first tick is always there";
  SafetyStatus status{kStarting, TripCause::kNone};
  int refused = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const SafetyRecord& record = records[i];
    EXPECT_EQ(record.before, status) << "no transition between two records";
    const SafetyDecision decision = NextSafetyState(record.before, record.facts);
    EXPECT_EQ(decision.status, record.after);
    EXPECT_EQ(decision.refusal, record.refusal);
    EXPECT_TRUE(i == 0 || record.due_ns > records[i - 1].due_ns);
    refused += record.refusal != Refusal::kNone;
    status = record.after;
  }
  EXPECT_EQ(refused, 2);
  EXPECT_EQ(status, safety_.status());
  EXPECT_EQ(records.back().after, (SafetyStatus{kTripped, TripCause::kLimitSwitch2High}));
  EXPECT_EQ(records.back().evidence.channel, 2u);
  const std::size_t count = records.size();
  RunFor(1000 * kMs);
  EXPECT_EQ(Records().size(), count) << "no change, no record";
}

}  // namespace
}  // namespace flexarm
