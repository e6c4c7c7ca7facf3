#include "controller/operator/request_tracker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/operator/still_stack.h"

namespace flexarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

RequestAnswer AnswerTo(std::uint32_t number, RequestKind kind) {
  return {.number = number,
          .kind = kind,
          .refusal = Refusal::kNone,
          .state = SafetyState::kIdle,
          .present = 0};
}

struct RequestTrackerTest : testing::Test {
  RequestTrackerTest() { latch.Open(); }

  std::uint32_t Ask(RequestKind kind, int client, const RunOrder& run = {}) {
    return tracker.Ask(kind, 40, client, run).number;
  }

  StillStack stack;
  LatchFolder folder;
  TripLatch latch{folder.path(), "/runs", [](bool, const std::string&) {}};
  RequestTracker tracker{&stack, &latch};
};

TEST_F(RequestTrackerTest, ARequestCountsFromNowOnWithTheNextNumber) {
  EXPECT_EQ(Ask(RequestKind::kRun, 7, {.experiment = nullptr, .may_open = 0b10}), 1'001u)
      << "unattended ones are 1, 2, ..";
  const std::vector<OperatorRequest> made = stack.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0].kind, RequestKind::kRun);
  EXPECT_EQ(made[0].number, 1'001u);
  EXPECT_EQ(made[0].not_before_ns, 40);
  EXPECT_EQ(made[0].run.may_open, 0b10);
}

TEST_F(RequestTrackerTest, AStopAndADisarmAreLatchedAndNotQueued) {
  EXPECT_EQ(Ask(RequestKind::kStop, 7), 1'001u);
  EXPECT_EQ(Ask(RequestKind::kDisarm, 8), 1'002u);
  EXPECT_THAT(stack.TakeRequests(), IsEmpty());
  EXPECT_EQ(stack.stop().Take(), 1'001u);
  EXPECT_EQ(stack.stop().Take(), 0u);
  EXPECT_EQ(stack.disarm().Take(), 1'002u);
}

TEST_F(RequestTrackerTest, OneArmRunOrResetAtATime) {
  for (const RequestKind first : {RequestKind::kArm, RequestKind::kRun, RequestKind::kReset}) {
    const std::uint32_t number = Ask(first, 7);
    EXPECT_TRUE(tracker.busy());
    for (const RequestKind next : {RequestKind::kArm, RequestKind::kRun, RequestKind::kReset}) {
      EXPECT_EQ(tracker.Ask(next, 0, 8).refusal, Refusal::kBusy)
          << ToString(first) << ", " << ToString(next);
    }
    EXPECT_NE(Ask(RequestKind::kStop, 8), 0u) << "a stop is always made";
    EXPECT_EQ(stack.TakeRequests().size(), 1u);
    EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(number, first)), ElementsAre(7));
    EXPECT_FALSE(tracker.busy());
  }
}

TEST_F(RequestTrackerTest, ARequestOfAnUnattendedRunKeepsItBusyToo) {
  const RequestTracker::Asked planned =
      tracker.AskPlanned({.kind = RequestKind::kArm, .number = 1, .not_before_ns = 100});
  EXPECT_EQ(planned.number, 1u);
  EXPECT_EQ(planned.refusal, Refusal::kNone);
  EXPECT_EQ(Ask(RequestKind::kArm, 7), 0u);
  EXPECT_EQ(stack.TakeRequests().size(), 1u);
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1, RequestKind::kArm)), IsEmpty());
  tracker.AskPlanned({.kind = RequestKind::kDisarm, .number = 2, .not_before_ns = 100});
  EXPECT_FALSE(tracker.busy()) << "a disarm adds no energy";
}

TEST_F(RequestTrackerTest, AChangeIsAskedForLikeARun) {
  constexpr int kClient = 7;
  const auto ask = [this](int client) {
    return tracker.AskForChange(40, client, {.experiment = nullptr, .may_open = 0b10}, 5, 90);
  };
  const RequestTracker::Asked asked = ask(kClient);
  EXPECT_EQ(asked.number, 1'001U);
  EXPECT_EQ(asked.refusal, Refusal::kNone);
  const std::vector<OperatorRequest> made = stack.TakeRequests();
  ASSERT_EQ(made.size(), 1U);
  EXPECT_EQ(made[0].kind, RequestKind::kChange);
  EXPECT_EQ(made[0].number, 1'001U);
  EXPECT_EQ(made[0].not_before_ns, 40);
  EXPECT_EQ(made[0].run.may_open, 0b10);
  EXPECT_EQ(made[0].changes, 5U);
  EXPECT_EQ(made[0].not_after_ns, 90);
  EXPECT_TRUE(tracker.busy());
  const RequestTracker::Asked second = ask(8);
  EXPECT_EQ(second.number, 0U);
  EXPECT_EQ(second.refusal, Refusal::kBusy);
  EXPECT_THAT(stack.TakeRequests(), IsEmpty());
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'001, RequestKind::kChange)), ElementsAre(kClient));
  EXPECT_FALSE(tracker.busy());
  EXPECT_EQ(ask(RequestTracker::kNoClient).number, 1'002U);
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'002, RequestKind::kChange)), IsEmpty());
}

TEST_F(RequestTrackerTest, AnArmIsAskedForOnlyOnceTheLatchFileSaysSo) {
  EXPECT_NE(Ask(RequestKind::kReset, 7), 0u);
  EXPECT_FALSE(folder.Has(TripLatch::kFile)) << "of arms alone";
  tracker.TakeClientsOf(AnswerTo(1'001, RequestKind::kReset));
  stack.TakeRequests();
  {
    const FullDisk full;
    const RequestTracker::Asked refused = tracker.Ask(RequestKind::kArm, 0, 7);
    EXPECT_EQ(refused.number, 0u);
    EXPECT_EQ(refused.refusal, Refusal::kNotKept);
    EXPECT_THAT(refused.why, testing::HasSubstr(TripLatch::kFile));
    const OperatorRequest planned{.kind = RequestKind::kArm, .number = 1, .not_before_ns = 100};
    EXPECT_EQ(tracker.AskPlanned(planned).refusal, Refusal::kNotKept);
    EXPECT_THAT(stack.TakeRequests(), IsEmpty());
    EXPECT_FALSE(tracker.busy());
    EXPECT_NE(Ask(RequestKind::kStop, 7), 0u) << "a stop needs no file";
  }
  EXPECT_NE(Ask(RequestKind::kArm, 7), 0u);
  EXPECT_TRUE(folder.Has(TripLatch::kFile)) << "before the safety task can grant it";
}

TEST_F(RequestTrackerTest, EachClientGetsTheAnswerToItsOwnRequestOnce) {
  Ask(RequestKind::kArm, 7);
  Ask(RequestKind::kStop, 8);
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'002, RequestKind::kStop)), ElementsAre(8))
      << "answered before the arm, which was made before it";
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'001, RequestKind::kArm)), ElementsAre(7));
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'001, RequestKind::kArm)), IsEmpty());
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'002, RequestKind::kStop)), IsEmpty());
}

TEST_F(RequestTrackerTest, StopsThatAreNotAnsweredYetShareAnAnswer) {
  for (int client = 0; client < 300; ++client) Ask(RequestKind::kStop, client);
  Ask(RequestKind::kDisarm, 1'000);
  const std::uint32_t newest = stack.stop().Take();
  EXPECT_EQ(newest, 1'300u);
  EXPECT_EQ(tracker.TakeClientsOf(AnswerTo(newest, RequestKind::kStop)).size(), 300u);
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'301, RequestKind::kDisarm)), ElementsAre(1'000));
}

TEST_F(RequestTrackerTest, AnAnswerThatNoClientWaitsForGoesToNone) {
  tracker.Ask(RequestKind::kRun, 0);
  Ask(RequestKind::kDisarm, 7);
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1, RequestKind::kArm)), IsEmpty())
      << "of an unattended run";
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'001, RequestKind::kRun)), IsEmpty());
  EXPECT_THAT(tracker.TakeClientsOf(AnswerTo(1'002, RequestKind::kDisarm)), ElementsAre(7));
}

}  // namespace
}  // namespace flexarm
