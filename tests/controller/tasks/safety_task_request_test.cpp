#include <gtest/gtest.h>

#include <vector>

#include "controller/tasks/planned_experiment.h"
#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

// Requests of the operator, and the end of a run.

namespace flexarm {
namespace {

using enum SafetyState;

TEST_F(SafetyTaskTest, AfterTheExperimentTheArmIsDampedThenArmed) {
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

TEST_F(SafetyTaskTest, PlannedRequestsAreJudgedAtTheirTickInOrder) {
  Ask(RequestKind::kArm, 100 * kMs);
  Ask(RequestKind::kRun, 200 * kMs + 1);  // between two ticks: judged at the next
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

// What holds when the arm is armed holds until the relay is open again.
TEST_F(SafetyTaskTest, TakesOtherLimitsOnlyWhileTheRelayIsOpen) {
  RunFor(10 * kMs);
  EXPECT_FALSE(permit().reduced);
  GoTo(kRunning);
  reduced_ = true;
  RunFor(200 * kMs);
  EXPECT_FALSE(permit().reduced);
  stop_.Set(++number_);
  control_.report.at_rest = true;
  RunFor(100 * kMs);
  ASSERT_EQ(safety_.status().state, kArmed);
  EXPECT_FALSE(permit().reduced);
  disarm_.Set(++number_);
  RunFor(200 * kMs);
  ASSERT_EQ(safety_.status().state, kIdle);
  EXPECT_TRUE(permit().reduced);
  reduced_ = false;
  RunFor(kMs);
  EXPECT_FALSE(permit().reduced);
}

// An arm that is asked for after the limits were reduced finds them reduced.
TEST_F(SafetyTaskTest, AnArmHasTheLimitsThatWereSetBeforeIt) {
  RunFor(100 * kMs);
  reduced_ = true;
  ASSERT_EQ(Now(RequestKind::kArm), Refusal::kNone);
  EXPECT_TRUE(permit().reduced);
}

// Changes of the path of a run: only of the present one, and only in time.
class SafetyTaskChangeTest : public SafetyTaskTest {
 protected:
  Refusal Change(std::uint32_t of_run, std::int64_t not_after_ns) {
    EXPECT_TRUE(requests_.Push({.kind = RequestKind::kChange,
                                .number = ++number_,
                                .not_before_ns = INT64_MIN,
                                .run = {.experiment = &changed_},
                                .changes = of_run,
                                .not_after_ns = not_after_ns}));
    RunFor(kMs);
    RequestAnswer answer{};
    while (answers_.Pop(&answer)) {
      if (answer.number == number_) return answer.refusal;
    }
    ADD_FAILURE() << "no answer";
    return Refusal::kNone;
  }
  PlannedExperiment changed_{std::vector<std::array<double, 2>>(10)};
};

TEST_F(SafetyTaskChangeTest, IsInThePermitOfTheRunThatGoesOn) {
  GoTo(kRunning);
  const std::uint32_t run = permit().run_number;
  EXPECT_EQ(permit().change.number, 0u);
  ASSERT_EQ(Change(run, executor_.next_ns()), Refusal::kNone);
  EXPECT_EQ(permit().change.number, number_);
  EXPECT_EQ(permit().change.experiment, &changed_);
  EXPECT_EQ(permit().run_number, run) << "the same run";
  EXPECT_EQ(safety_.status().state, kRunning);
  control_.report.experiment_done = control_.report.at_rest = true;
  RunFor(100 * kMs);
  ASSERT_EQ(safety_.status().state, kArmed);
  control_.report.experiment_done = false;
  ASSERT_EQ(Now(RequestKind::kRun), Refusal::kNone);
  EXPECT_EQ(permit().change.number, 0u) << "of a new run there is none";
}

TEST_F(SafetyTaskChangeTest, IsRefusedAfterItsInstantOfAnotherRunAndWithoutOne) {
  EXPECT_EQ(Change(0, INT64_MAX), Refusal::kWrongState);
  GoTo(kRunning);
  const std::uint32_t run = permit().run_number;
  EXPECT_EQ(Change(run, executor_.next_ns() - 1), Refusal::kTooLate);
  shutting_down_ = true;  // so that the tick has a record
  EXPECT_EQ(Change(run + 1, INT64_MAX), Refusal::kTooLate);
  EXPECT_EQ(permit().change.number, 0u);
  for (const SafetyRecord& record : Records()) {
    EXPECT_FALSE(record.facts.request == RequestKind::kChange && record.before.state == kRunning)
        << "the machine has not judged it";
    EXPECT_EQ(record.request_number == 0, record.facts.request == RequestKind::kNone);
  }
  control_.report.experiment_done = true;
  RunFor(40 * kMs);
  EXPECT_EQ(Change(run, INT64_MAX), Refusal::kWrongState) << "it stops";
}

TEST_F(SafetyTaskChangeTest, IsCancelledByAStop) {
  GoTo(kRunning);
  const std::uint32_t change = Ask(RequestKind::kChange, executor_.next_ns() + 500 * kMs);
  RunFor(kMs);
  stop_.Set(++number_);
  RunFor(2 * kMs);
  RequestAnswer answer{};
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.kind, RequestKind::kStop);
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.number, change);
  EXPECT_EQ(answer.refusal, Refusal::kCancelled);
}

TEST_F(SafetyTaskTest, ARunWaitsUntilTheDrivesAreOn) {
  RunFor(100 * kMs);
  Ask(RequestKind::kArm);
  Ask(RequestKind::kRun);
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kArmed);
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kArmed) << "the drive has not confirmed yet";
  RunFor(3 * kMs);
  EXPECT_EQ(safety_.status().state, kRunning);
}

TEST_F(SafetyTaskTest, DrivesThatDoNotSwitchOnRefuseTheRun) {
  drive_.stuck_off = true;
  GoTo(kArmed);
  const std::uint32_t run = Ask(RequestKind::kRun);
  std::int64_t armed_ns = 0;
  for (const SafetyRecord& record : Records()) {
    if (record.after.state != record.before.state) armed_ns = record.due_ns;
  }
  executor_.RunUntil(armed_ns + SafetyTask::kEnableNs + 1);
  RequestAnswer answer{};
  while (answers_.Pop(&answer)) EXPECT_NE(answer.number, run) << "it waits";
  RunFor(kMs);
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.number, run);
  EXPECT_EQ(answer.refusal, Refusal::kDrivesOff);
}

TEST_F(SafetyTaskTest, TheRelayOpensWhenTheDrivesAreOffOrAfterAHundredMilliseconds) {
  for (const bool confirms : {true, false}) {
    GoTo(kArmed);
    drive_.stuck_on = !confirms;
    RequestAnswer answer{};
    while (answers_.Pop(&answer)) {
    }
    const std::uint32_t disarm = Ask(RequestKind::kDisarm);
    RunFor(kMs);
    EXPECT_EQ(safety_.status().state, kDisarming);
    EXPECT_FALSE(answers_.Pop(&answer)) << "the answer means that the relay is open";
    std::int64_t closed_ns = 0;
    for (; lines_.relay_closed(); closed_ns += kMs) RunFor(kMs);
    EXPECT_EQ(safety_.status().state, kIdle);
    EXPECT_LE(closed_ns, (confirms ? 4 : 101) * kMs);
    EXPECT_GE(closed_ns, (confirms ? 1 : 100) * kMs);
    ASSERT_TRUE(answers_.Pop(&answer));
    EXPECT_EQ(answer.number, disarm);
    EXPECT_EQ(answer.refusal, Refusal::kNone);
    drive_.stuck_on = false;
  }
}

TEST_F(SafetyTaskTest, ASoftLimitKeepsThePowerForTheDampingThenTrips) {
  GoTo(kRunning);
  control_.report.may_damp = true;
  control_.report.faults = CauseBit(TripCause::kSoftLimit2);
  control_.report.evidence = {.value = 1.6, .limit = 1.5, .channel = 2, .detail = 0};
  RunFor(45 * kMs);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kFaultStopping, TripCause::kSoftLimit2}));
  EXPECT_TRUE(lines_.relay_closed());
  EXPECT_EQ(drive_.torque_nm[0], 1.0);
  control_.report.evidence = {};
  const std::int64_t begun_ns = executor_.next_ns();
  EXPECT_LE(RunUntilTripped(600 * kMs) - begun_ns, kLimits.fault_stop_ns);
  EXPECT_EQ(permit().evidence.value, 1.6) << "of the cause, not of the end";
  EXPECT_FALSE(lines_.relay_closed());
}

TEST_F(SafetyTaskTest, JudgesOneRequestInATickInTheOrderOfTheQueue) {
  GoTo(kIdle);
  const std::vector<std::uint32_t> asked{Ask(RequestKind::kArm), Ask(RequestKind::kReset),
                                         Ask(RequestKind::kArm)};
  for (const std::uint32_t number : asked) {
    RunFor(kMs);
    RequestAnswer answer{};
    ASSERT_TRUE(answers_.Pop(&answer));
    EXPECT_EQ(answer.number, number);
    EXPECT_FALSE(answers_.Pop(&answer));
  }
}

// Those that wait keep their order, whichever of them is due first.
TEST_F(SafetyTaskTest, ARequestThatIsDuePassesThoseThatWait) {
  GoTo(kIdle);
  const std::int64_t now_ns = executor_.next_ns();
  const std::uint32_t arm = Ask(RequestKind::kArm, now_ns + 20 * kMs);
  const std::uint32_t reset = Ask(RequestKind::kReset, now_ns + 10 * kMs);
  const std::uint32_t again = Ask(RequestKind::kArm, now_ns + 20 * kMs);
  std::vector<RequestAnswer> answers;
  RequestAnswer answer{};
  while (answers_.Pop(&answer)) {
  }
  RunFor(50 * kMs);
  while (answers_.Pop(&answer)) answers.push_back(answer);
  ASSERT_EQ(answers.size(), 3U);
  EXPECT_EQ(answers[0].number, reset);
  EXPECT_EQ(answers[1].number, arm);
  EXPECT_EQ(answers[1].refusal, Refusal::kNone);
  EXPECT_EQ(answers[2].number, again);
  EXPECT_EQ(answers[2].refusal, Refusal::kWrongState);
}

}  // namespace
}  // namespace flexarm
