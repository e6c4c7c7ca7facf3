#include "controller/operator/request_tracker.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

RequestAnswer AnswerTo(std::uint32_t number) {
  return {.number = number,
          .kind = RequestKind::kArm,
          .refusal = Refusal::kNone,
          .state = SafetyState::kIdle,
          .present = 0};
}

struct RequestTrackerTest : testing::Test {
  OperatorRequest Next() {
    OperatorRequest request{};
    EXPECT_TRUE(requests.Pop(&request));
    return request;
  }

  SpscQueue<OperatorRequest> requests{64};
  RequestTracker tracker{&requests};
};

TEST_F(RequestTrackerTest, ARequestCountsFromNowOnWithTheNextNumber) {
  EXPECT_EQ(tracker.Ask(RequestKind::kRun, 40, 0b10), 1'001u) << "unattended ones are 1, 2, ..";
  tracker.AskFor(7, RequestKind::kStop, 60);
  const OperatorRequest run = Next();
  EXPECT_EQ(run.kind, RequestKind::kRun);
  EXPECT_EQ(run.number, 1'001u);
  EXPECT_EQ(run.not_before_ns, 40);
  EXPECT_EQ(run.may_open, 0b10);
  const OperatorRequest stop = Next();
  EXPECT_EQ(stop.kind, RequestKind::kStop);
  EXPECT_EQ(stop.number, 1'002u);
  EXPECT_EQ(stop.not_before_ns, 60);
  EXPECT_EQ(stop.may_open, 0);
}

TEST_F(RequestTrackerTest, EachClientGetsTheAnswerToItsOwnRequestOnce) {
  tracker.AskFor(7, RequestKind::kArm, 0);
  tracker.AskFor(8, RequestKind::kStop, 0);
  EXPECT_EQ(tracker.TakeClientOf(AnswerTo(1'001)), 7);
  EXPECT_EQ(tracker.TakeClientOf(AnswerTo(1'001)), std::nullopt);
  EXPECT_EQ(tracker.TakeClientOf(AnswerTo(1'002)), 8);
  EXPECT_EQ(tracker.TakeClientOf(AnswerTo(1'002)), std::nullopt);
}

TEST_F(RequestTrackerTest, AnAnswerThatNoClientWaitsForGoesToNone) {
  tracker.Ask(RequestKind::kStop, 0);
  tracker.AskFor(7, RequestKind::kDisarm, 0);
  EXPECT_EQ(tracker.TakeClientOf(AnswerTo(1)), std::nullopt) << "of an unattended run";
  EXPECT_EQ(tracker.TakeClientOf(AnswerTo(1'001)), std::nullopt) << "of the shutdown";
  EXPECT_EQ(tracker.TakeClientOf(AnswerTo(1'002)), 7);
}

}  // namespace
}  // namespace flexarm
