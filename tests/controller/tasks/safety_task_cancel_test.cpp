// What a stop, a disarm and a trip cancel of the requests that wait.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

namespace flexarm {
namespace {

using enum SafetyState;

TEST_F(SafetyTaskTest, AStopPrecedesPlannedRequestsAndCancelsThePlannedRun) {
  GoTo(kRunning);
  const std::uint32_t planned_run = Ask(RequestKind::kRun, executor_.next_ns() + 500 * kMs);
  Ask(RequestKind::kDisarm, executor_.next_ns() + 1000 * kMs);
  RunFor(kMs);
  stop_.Set(++number_);
  const std::uint32_t later_run = Ask(RequestKind::kRun, executor_.next_ns() + 5000 * kMs);
  RunFor(kMs);
  EXPECT_EQ(safety_.status().state, kStopping);
  RunFor(kMs);
  RequestAnswer answer{};
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.kind, RequestKind::kStop);
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.number, planned_run);
  EXPECT_EQ(answer.refusal, Refusal::kCancelled);
  EXPECT_FALSE(answers_.Pop(&answer))
      << "the planned disarm and the requests after the stop are kept";
  control_.report.at_rest = true;
  RunFor(1000 * kMs + 5 * kMs);
  EXPECT_EQ(safety_.status().state, kIdle) << "armed at rest, then disarmed as planned";
  lines_.levels = 0;
  RunFor(3 * kMs);
  while (answers_.Pop(&answer)) {
  }
  EXPECT_EQ(answer.number, later_run);
  EXPECT_EQ(answer.refusal, Refusal::kCancelled) << "a trip cancels all";
}

// The task takes one request from the queue in a tick, so some are still in it when the stop comes.
TEST_F(SafetyTaskTest, AStopCancelsWhatIsStillInTheQueueAndNotWhatCameAfterIt) {
  GoTo(kRunning);
  std::vector<std::uint32_t> before(5);
  for (std::uint32_t& number : before) number = Ask(RequestKind::kRun, executor_.next_ns() + kMs);
  stop_.Set(++number_);
  const std::uint32_t after = Ask(RequestKind::kRun, executor_.next_ns() + kMs);
  RunFor(10 * kMs);
  RequestAnswer answer{};
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.kind, RequestKind::kStop);
  for (const std::uint32_t number : before) {
    ASSERT_TRUE(answers_.Pop(&answer));
    EXPECT_EQ(answer.number, number);
    EXPECT_EQ(answer.refusal, Refusal::kCancelled);
  }
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.number, after);
  EXPECT_EQ(answer.refusal, Refusal::kWrongState) << "Stopping";
}

TEST_F(SafetyTaskTest, ADisarmCancelsAPlannedArmAndAResetDoesNot) {
  GoTo(kIdle);
  const std::uint32_t arm = Ask(RequestKind::kArm, executor_.next_ns() + 500 * kMs);
  RunFor(kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kWrongState);
  RunFor(10 * kMs);
  RequestAnswer answer{};
  EXPECT_FALSE(answers_.Pop(&answer)) << "it waits";
  disarm_.Set(++number_);
  RunFor(2 * kMs);
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.kind, RequestKind::kDisarm);
  ASSERT_TRUE(answers_.Pop(&answer));
  EXPECT_EQ(answer.number, arm);
  EXPECT_EQ(answer.refusal, Refusal::kCancelled);
}

// Those of an unattended run have numbers of their own, below those of clients.
TEST_F(SafetyTaskTest, AStopDoesNotCancelWhatIsAskedForLaterWithALowerNumber) {
  GoTo(kIdle);
  stop_.Set(number_ + 1000);
  RunFor(kMs);
  RequestAnswer stop{};
  ASSERT_TRUE(answers_.Pop(&stop));
  EXPECT_EQ(stop.refusal, Refusal::kWrongState);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kNone);
}

// Of 1, 2, 3, ... requests that were there before a stop, one asked for after it is not cancelled.
TEST_F(SafetyTaskTest, WhatWasInTheQueueIsCountedOnce) {
  GoTo(kIdle);
  for (const int before : {1, 2, 5}) {
    number_ = 100;
    for (int i = 0; i < before; ++i) Ask(RequestKind::kArm, executor_.next_ns() + 5000 * kMs);
    stop_.Set(1000);
    RunFor(20 * kMs);
    RequestAnswer answer{};
    int cancelled = 0;
    while (answers_.Pop(&answer)) cancelled += answer.refusal == Refusal::kCancelled ? 1 : 0;
    EXPECT_EQ(cancelled, before);
    EXPECT_EQ(Now(RequestKind::kReset), Refusal::kWrongState);
    EXPECT_EQ(Now(RequestKind::kArm), Refusal::kNone) << "of a lower number, and later";
    Ask(RequestKind::kDisarm);
    RunFor(200 * kMs);
  }
}

TEST_F(SafetyTaskTest, AStopOfALowerNumberKeepsWhatAnEarlierOneCancelled) {
  GoTo(kIdle);
  number_ = 100;
  for (int i = 0; i < 4; ++i) Ask(RequestKind::kArm, executor_.next_ns() + 5000 * kMs);
  stop_.Set(200);
  RunFor(kMs);
  stop_.Set(50);
  RunFor(20 * kMs);
  std::vector<std::uint32_t> cancelled;
  RequestAnswer answer{};
  while (answers_.Pop(&answer)) {
    if (answer.refusal == Refusal::kCancelled) cancelled.push_back(answer.number);
  }
  EXPECT_EQ(cancelled, (std::vector<std::uint32_t>{101, 102, 103, 104}));
}

TEST_F(SafetyTaskTest, AStopOfALowerNumberDoesNotCancelForAnEarlierOneThatIsDone) {
  GoTo(kIdle);
  stop_.Set(1000);
  RunFor(kMs);
  number_ = 100;
  for (int i = 0; i < 4; ++i) Ask(RequestKind::kArm, executor_.next_ns() + 5000 * kMs);
  stop_.Set(50);
  RunFor(20 * kMs);
  RequestAnswer answer{};
  while (answers_.Pop(&answer)) EXPECT_EQ(answer.kind, RequestKind::kStop) << answer.number;
}

TEST_F(SafetyTaskTest, AStopCancelsAsManyAsCanWait) {
  GoTo(kIdle);
  const auto most = static_cast<int>(SafetyTask::kMaxWaiting);
  for (int i = 0; i < most + 1; ++i) Ask(RequestKind::kArm, executor_.next_ns() + 5000 * kMs);
  RunFor(50 * kMs);
  stop_.Set(++number_);
  RunFor(50 * kMs);
  RequestAnswer answer{};
  int cancelled = 0;
  while (answers_.Pop(&answer)) cancelled += answer.refusal == Refusal::kCancelled ? 1 : 0;
  EXPECT_EQ(cancelled, most + 1) << "and the one that had no place";
}

TEST_F(SafetyTaskTest, NoRequestFromBeforeATripIsCarriedOutAfterTheReset) {
  GoTo(kIdle);
  const std::int64_t later_ns = executor_.next_ns() + 5000 * kMs;
  const std::vector<std::uint32_t> asked{Ask(RequestKind::kArm, later_ns),
                                         Ask(RequestKind::kArm, later_ns),
                                         Ask(RequestKind::kArm, later_ns)};
  lines_.levels &= ~LineBit(Line::kEmergencyStop);  // trips in the second tick
  RunFor(10 * kMs);
  ASSERT_EQ(safety_.status().state, kTripped);
  RequestAnswer answer{};
  for (const std::uint32_t number : asked) {
    ASSERT_TRUE(answers_.Pop(&answer));
    EXPECT_EQ(answer.number, number);
    EXPECT_EQ(answer.refusal, Refusal::kCancelled);
  }
  EXPECT_FALSE(answers_.Pop(&answer));
}

}  // namespace
}  // namespace flexarm
