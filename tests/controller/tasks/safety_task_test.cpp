#include "controller/tasks/safety_task.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/controller/tasks/safety_task_bench.h"

// States, relay and charge pump, permit, and records.

namespace flexarm {
namespace {

using enum SafetyState;

TEST_F(SafetyTaskTest, IsDueEveryMillisecondBeforeAllOthers) {
  const Task::Traits traits = safety_.traits();
  EXPECT_STREQ(traits.name, "safety");
  EXPECT_EQ(traits.period_ns, kMs);
  EXPECT_EQ(traits.phase_ns, 0);
  EXPECT_EQ(traits.deadline_ns, kMs);
  EXPECT_EQ(traits.priority, 90);
}

TEST_F(SafetyTaskTest, EntersIdleWhenEveryTaskHasReportedAndStaysThere) {
  RunFor(15 * kMs);  // the first step's report is valid from 5 + 10 ms on
  EXPECT_EQ(safety_.status().state, kStarting);
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kIdle);
  RunFor(2000 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle) << "no arming without a request";
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
  RunFor(kMs);  // its first sample
  lines_.written.clear();
  RunFor(10 * kMs);
  for (const auto& written : lines_.written) {
    EXPECT_FALSE(written.outputs.relay_closed);
    EXPECT_FALSE(written.outputs.pump_level);
  }
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

// The records are sufficient to run the state machine again: the same transitions and no others.
TEST_F(SafetyTaskTest, TheRecordsReplayToTheSameTransitions) {
  GoTo(kRunning);
  ASSERT_EQ(Now(RequestKind::kDisarm), Refusal::kWrongState);
  ASSERT_EQ(Now(RequestKind::kDisarm), Refusal::kWrongState);  // the same facts twice in a row
  lines_.levels &= ~LineBit(Line::kLimit2High);
  RunFor(100 * kMs);
  const std::vector<SafetyRecord> records = Records();
  ASSERT_GT(records.size(), 8u);
  EXPECT_EQ(records.front().due_ns, 0) << "the first tick is always recorded";
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
