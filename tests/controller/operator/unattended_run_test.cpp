#include "controller/operator/unattended_run.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "controller/tasks/planned_experiment.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using enum SafetyState;

Permit PermitOf(SafetyState state, TripCause cause = TripCause::kNone) {
  Permit permit = kNoPermit;
  permit.state = state;
  permit.cause = cause;
  return permit;
}

Permit TrippedBy(TripCause cause) { return PermitOf(kTripped, cause); }

RequestAnswer RefusalOf(std::uint32_t number) {
  return {.number = number,
          .kind = RequestKind::kArm,
          .refusal = Refusal::kNotAtRest,
          .state = kIdle,
          .present = 0};
}

// Through a whole run; Idle again at 3 s.
void Finish(UnattendedRun* run) {
  run->Update(1'000 * kMs, PermitOf(kRunning));
  run->Update(2'000 * kMs, PermitOf(kArmed));
  run->Update(3'000 * kMs, PermitOf(kIdle));
}

TEST(UnattendedRun, ArmsRunsOnceAndDisarms) {
  const PlannedExperiment experiment(std::vector<std::array<double, 2>>(10));
  UnattendedRun run(&experiment);
  EXPECT_EQ(run.Update(0, PermitOf(kStarting)).kind, RequestKind::kNone);
  const OperatorRequest arm = run.Update(20 * kMs, PermitOf(kIdle));
  EXPECT_EQ(arm.kind, RequestKind::kArm);
  EXPECT_EQ(arm.number, 1u);
  EXPECT_EQ(arm.run.experiment, nullptr);
  EXPECT_EQ(arm.not_before_ns, 700 * kMs) << "half a second of rest must have been seen";
  EXPECT_EQ(run.Update(40 * kMs, PermitOf(kIdle)).kind, RequestKind::kNone) << "asked already";
  const OperatorRequest start = run.Update(720 * kMs, PermitOf(kArmed));
  EXPECT_EQ(start.kind, RequestKind::kRun);
  EXPECT_EQ(start.number, 2u);
  EXPECT_EQ(start.not_before_ns, 820 * kMs);
  EXPECT_EQ(start.run.experiment, &experiment);
  EXPECT_EQ(run.Update(840 * kMs, PermitOf(kRunning)).kind, RequestKind::kNone);
  EXPECT_EQ(run.Update(900 * kMs, PermitOf(kStopping)).kind, RequestKind::kNone);
  const OperatorRequest disarm = run.Update(2'000 * kMs, PermitOf(kArmed));
  EXPECT_EQ(disarm.kind, RequestKind::kDisarm) << "not a second run";
  EXPECT_EQ(disarm.number, 3u);
  EXPECT_FALSE(run.over());
  run.Update(2'200 * kMs, PermitOf(kIdle));
  EXPECT_EQ(run.progress(), UnattendedRun::Progress::kDone);
  EXPECT_TRUE(run.ran());
}

TEST(UnattendedRun, IsOverItsSettlingTimeAfterIdle) {
  UnattendedRun lockstep(nullptr);
  UnattendedRun daemon(nullptr, 300 * kMs);
  EXPECT_EQ(lockstep.over_ns(), INT64_MAX);
  Finish(&lockstep);
  Finish(&daemon);
  EXPECT_EQ(lockstep.over_ns(), 3'200 * kMs);
  EXPECT_EQ(daemon.over_ns(), 3'300 * kMs);
  daemon.Update(3'020 * kMs, PermitOf(kIdle));
  EXPECT_EQ(daemon.over_ns(), 3'300 * kMs) << "counted from its end";
  EXPECT_EQ(daemon.trip(), TripCause::kNone);
}

TEST(UnattendedRun, IsOverFiveSecondsAfterItsFirstTrip) {
  UnattendedRun run(nullptr);
  run.Update(1'000 * kMs, PermitOf(kRunning));
  EXPECT_EQ(run.Update(1'020 * kMs, TrippedBy(TripCause::kHubRate1)).kind, RequestKind::kNone);
  EXPECT_TRUE(run.over());
  EXPECT_EQ(run.over_ns(), 6'020 * kMs);
  run.Update(1'040 * kMs, TrippedBy(TripCause::kHubRate1));
  run.Update(1'060 * kMs, PermitOf(kIdle));
  run.Update(1'080 * kMs, TrippedBy(TripCause::kEmergencyStop));
  EXPECT_EQ(run.over_ns(), 6'020 * kMs);
  EXPECT_EQ(run.trip(), TripCause::kHubRate1);
}

TEST(UnattendedRun, ATripWhileItSettlesIsRecordedAsLong) {
  UnattendedRun run(nullptr);
  Finish(&run);
  run.Update(3'100 * kMs, TrippedBy(TripCause::kEmergencyStop));
  EXPECT_EQ(run.over_ns(), 8'100 * kMs);
  EXPECT_EQ(run.trip(), TripCause::kEmergencyStop);
}

TEST(UnattendedRun, ARefusalOfItsNewestRequestEndsIt) {
  UnattendedRun run(nullptr);
  run.Update(700 * kMs, PermitOf(kIdle));
  run.Answered(RefusalOf(1'001));
  EXPECT_FALSE(run.over()) << "a client's request";
  run.Answered(RefusalOf(1));
  EXPECT_EQ(run.progress(), UnattendedRun::Progress::kRefused);
  EXPECT_EQ(run.Update(900 * kMs, PermitOf(kIdle)).kind, RequestKind::kNone);
  EXPECT_EQ(run.over_ns(), 1'100 * kMs);
  EXPECT_FALSE(run.ran());
}

}  // namespace
}  // namespace flexarm
