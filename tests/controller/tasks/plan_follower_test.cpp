// When the control task requests plans, the content of the requests, and the plan that it follows.

#include "controller/tasks/plan_follower.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"
#include "tests/support/no_alloc.h"

namespace flexarm {
namespace {

constexpr PlanSchedule kSchedule{.every = 10, .ready = 5, .rest = 20, .period_ns = kPeriodNs};

ReferenceTable MovesOf(double duration_s, const std::vector<double>& starts_s) {
  Experiment experiment{};
  experiment.name = "moves";
  experiment.duration_s = starts_s.back() + duration_s + 2.0;
  for (const double start_s : starts_s) {
    experiment.move.push_back({.start_s = start_s,
                               .duration_s = duration_s,
                               .to_deg = {10.0 * start_s, -5.0},
                               .profile = MoveProfile::kSeptic});
  }
  return {experiment, ShippedPathDesign(), kPeriod_s, {0.0, 0.0}, ShippedLimits()};
}

// A move from sample 50 to 150, and one from sample 154 to 254: less than the 20 periods of rest of
// a plan after the first.
const ReferenceTable& TwoMoves() {
  static const ReferenceTable table = MovesOf(2.0, {1.0, 3.08});
  return table;
}

StepOutput AnOutput() {
  StepOutput out{};
  out.payload_kg = 0.3;
  out.payload_sigma_kg = 0.02;
  out.mean_nis = 9.0;
  out.payload_warnings = kPayloadAtBound;
  out.friction_nm = {0.16, 0.01};
  for (std::size_t i = 0; i < 12; ++i) out.x_next[i] = 0.1 * static_cast<double>(i);
  return out;
}

class PlanFollowerTest : public testing::Test {
 protected:
  PlanFollowerTest() { follower_.Start(7); }

  // Runs the samples `from` to `to`. @returns the requests made
  std::vector<PlanRequest> AskedBetween(int from, int to) {
    std::vector<PlanRequest> asked;
    for (int sample = from; sample <= to; ++sample) {
      follower_.Ask(sample, sample * kPeriodNs, TwoMoves(), AnOutput());
      const PlanRequest& newest = requests_->Read();
      if (newest.number != seen_) asked.push_back(newest);
      seen_ = newest.number;
    }
    return asked;
  }

  void Publish(std::uint32_t run, int first, double angle_rad, std::int64_t from_ns) {
    auto motion = std::make_unique<MotionPlan>();
    motion->run = run;
    motion->number = requests_->Read().number;
    motion->plan.Begin(first, 0.3);
    for (int k = 0; k < 20; ++k) {
      const auto x = Eigen::Matrix<double, 12, 1>::Constant(angle_rad + k);
      motion->plan.Append({.motion = MotionSample::Of(x, {1.0, 2.0 + k}), .K = {}});
    }
    history_->Push(from_ns, *motion);
    plans_->Publish(*history_);
  }

  std::unique_ptr<PlanRequestChannel> requests_ =
      std::make_unique<PlanRequestChannel>(PlanRequest{});
  std::unique_ptr<MotionPlanHistory> history_ = std::make_unique<MotionPlanHistory>(MotionPlan{});
  std::unique_ptr<MotionPlanChannel> plans_ =
      std::make_unique<MotionPlanChannel>(MotionPlanHistory(MotionPlan{}));
  PlanFollower follower_{kSchedule, requests_.get(), plans_.get()};
  std::uint32_t seen_ = 0;
};

TEST_F(PlanFollowerTest, RequestsPlansFromTheStartOfEachMoveAndEveryTenPeriods) {
  const std::vector<PlanRequest> asked = AskedBetween(0, 399);
  std::vector<int> first;
  for (const PlanRequest& request : asked) first.push_back(request.first);
  const std::vector<int> expected = {50,  60,  70,  80,  90,  100, 110, 120, 130, 140,
                                     154, 164, 174, 184, 194, 204, 214, 224, 234, 244};
  EXPECT_EQ(first, expected);
  for (const PlanRequest& request : asked) {
    EXPECT_EQ(request.sample, request.first - 5);
    EXPECT_EQ(request.needed_ns, request.first * kPeriodNs);
    EXPECT_EQ(request.run, 7u);
    EXPECT_EQ(request.segment, request.first < 154 ? 50 : 154);
    EXPECT_EQ(request.end, request.first < 154 ? 150 : 254);
  }
}

TEST_F(PlanFollowerTest, ARunThatStartsDuringAMoveRequestsAPlanAtOnce) {
  EXPECT_EQ(AskedBetween(80, 80).at(0).first, 85);
  EXPECT_EQ(AskedBetween(81, 95).at(0).first, 95) << "then every ten";
}

TEST_F(PlanFollowerTest, RequestsNoPlanForLessThanFivePeriods) {
  EXPECT_EQ(AskedBetween(140, 140).at(0).first, 145);
  follower_.Start(8);
  EXPECT_TRUE(AskedBetween(141, 148).empty());
}

// Ten periods after 145 the next move has started.
TEST_F(PlanFollowerTest, TheNextMoveDoesNotWaitForTheTenPeriodsOfTheOneBefore) {
  ASSERT_EQ(AskedBetween(140, 140).at(0).first, 145);
  EXPECT_EQ(AskedBetween(141, 155).at(0).first, 154);
}

TEST_F(PlanFollowerTest, TheNextRunDoesNotWaitForTheTenPeriodsOfTheOneBefore) {
  ASSERT_EQ(AskedBetween(45, 45).at(0).first, 50);
  follower_.Start(8);
  EXPECT_EQ(AskedBetween(46, 46).at(0).first, 51);
}

// A plan has at most 500 samples; this move has 600.
TEST_F(PlanFollowerTest, TheRequestOfALongMoveHasThePathOfTheLongestPlan) {
  const ReferenceTable table = MovesOf(12.0, {1.0});
  follower_.Ask(45, 45 * kPeriodNs, table, AnOutput());
  const PlanRequest& request = requests_->Read();
  ASSERT_EQ(request.points, PlanRequest::kMostPoints);
  EXPECT_EQ(request.end, 650);
  EXPECT_EQ(request.path[522].angle_rad, table.PathAround(44 + 522)[1].angle_rad);
}

TEST_F(PlanFollowerTest, TheRequestHasStatePayloadAndThePathOfTheHorizon) {
  const std::vector<PlanRequest> asked = AskedBetween(0, 200);
  const PlanRequest& first = asked.at(0);
  EXPECT_EQ(first.known.payload_kg, 0.3);
  EXPECT_EQ(first.known.payload_sigma_kg, 0.02);
  EXPECT_EQ(first.known.mean_nis, 9.0);
  EXPECT_EQ(first.known.warnings, static_cast<std::uint32_t>(kPayloadAtBound));
  EXPECT_EQ(first.known.friction_nm, AnOutput().friction_nm);
  EXPECT_EQ(first.x[11], AnOutput().x_next[11]);
  // From one before `sample` to one after the plan's end: at the start of the next move, ...
  EXPECT_EQ(static_cast<int>(first.points), 154 + 1 - (first.sample - 1) + 1);
  for (const std::uint32_t i : {0u, 6u, 60u, first.points - 1}) {
    const RigidPoint expected = TwoMoves().PathAround(first.sample - 1 + static_cast<int>(i))[1];
    EXPECT_EQ(first.path[i].angle_rad, expected.angle_rad) << i;
    EXPECT_EQ(first.path[i].acceleration_rad_s2, expected.acceleration_rad_s2) << i;
  }
  // ... or 20 periods after the end.
  const PlanRequest& last = asked.back();
  EXPECT_EQ(static_cast<int>(last.points), 254 + 20 + 1 - (last.sample - 1) + 1);
}

TEST_F(PlanFollowerTest, UsesThePlanThatIsValidWhenTheStepIsDue) {
  Publish(7, 60, 0.5, 60 * kPeriodNs);
  EXPECT_FALSE(follower_.At(59, 59 * kPeriodNs)) << "not valid yet";
  const std::optional<MotionSample> old = follower_.At(62, 62 * kPeriodNs);
  ASSERT_TRUE(old);
  EXPECT_EQ(old->x[3], 2.5);
  EXPECT_EQ(old->torque_nm[1], 4.0);

  Publish(7, 70, -0.5, 70 * kPeriodNs);  // published before it is valid
  EXPECT_EQ(follower_.At(69, 69 * kPeriodNs)->x[0], 9.5) << "the old plan until then";
  EXPECT_EQ(follower_.At(70, 70 * kPeriodNs)->x[0], -0.5);
  EXPECT_FALSE(follower_.At(90, 90 * kPeriodNs)) << "after its end";
}

TEST_F(PlanFollowerTest, UsesNoPlanOfAnotherRun) {
  Publish(7, 60, 0.5, 60 * kPeriodNs);
  follower_.Start(8);
  EXPECT_FALSE(follower_.At(62, 62 * kPeriodNs));
  EXPECT_EQ(AskedBetween(62, 62).at(0).run, 8u) << "and requests one for this run";
}

// A plan that was requested before is not used even if it is published after.
TEST_F(PlanFollowerTest, AModelMismatchInvalidatesThePlansAndRequestsANewOne) {
  const std::uint32_t before = AskedBetween(45, 55).back().number;
  Publish(7, 60, 0.5, 60 * kPeriodNs);
  ASSERT_TRUE(follower_.At(62, 62 * kPeriodNs));
  StepOutput dropped = AnOutput();
  dropped.payload_warnings = kPayloadModelMismatch;
  follower_.Ask(62, 62 * kPeriodNs, TwoMoves(), dropped);
  const PlanRequest& request = requests_->Read();
  EXPECT_EQ(request.number, before + 1);
  EXPECT_EQ(request.first, 67);
  EXPECT_EQ(request.valid_from, request.number);
  EXPECT_FALSE(follower_.At(63, 63 * kPeriodNs));
  Publish(7, 67, -0.5, 67 * kPeriodNs);
  EXPECT_EQ(follower_.At(67, 67 * kPeriodNs).value().x[0], -0.5);
  EXPECT_EQ(AskedBetween(63, 77).at(1).first, 77) << "then every ten";
}

TEST_F(PlanFollowerTest, NothingAllocates) {
  static_cast<void>(TwoMoves());
  const NoAlloc guard;
  for (int sample = 0; sample < 300; ++sample) {
    follower_.Ask(sample, sample * kPeriodNs, TwoMoves(), AnOutput());
    static_cast<void>(follower_.At(sample, sample * kPeriodNs));
  }
}

}  // namespace
}  // namespace flexarm
