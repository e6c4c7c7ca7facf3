// The planner's thread: what it makes of a request. That plans bring the tip to rest is shown in
// tests/controller/law/horizon_planner_test.cpp.

#include "controller/runtime/planner_task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "controller/law/path_reference.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/no_alloc.h"

namespace flexarm {
namespace {

constexpr double kPeriod_s = 0.02;
constexpr std::int64_t kPeriodNs = 20'000'000;
constexpr int kFirst = 50, kEnd = 150;  // of the move

Config Rig(const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> all = overrides;
  all.insert(all.begin(), "controller.name=receding-horizon");
  return ShippedRig(all);
}

const Design& DesignOfRig() {
  static const Design design = DesignController(Rig());
  return design;
}

const ReferenceTable& OneMove() {
  static const ReferenceTable table = [] {
    Experiment experiment{};
    experiment.name = "one-move";
    experiment.duration_s = 6.0;
    experiment.move.push_back({.start_s = 1.0,
                               .duration_s = 2.0,
                               .to_deg = {30.0, -40.0},
                               .profile = MoveProfile::kSeptic});
    return ReferenceTable(experiment, DesignOfRig(), kPeriod_s, {0.0, 0.0}, ShippedLimits());
  }();
  return table;
}

class PlannerTaskTest : public testing::Test {
 protected:
  void Make(const std::vector<std::string>& overrides = {}) {
    const Config config = Rig(overrides);
    planner_ = std::make_unique<PlannerTask>(config, DesignOfRig());
    follower_ = std::make_unique<PlanFollower>(PlanScheduleOf(config), &planner_->requests(),
                                               &planner_->plans());
    follower_->Start(1);
  }

  // The control task asks at a sample, and the planner runs.
  void AskAt(int sample, const PlanState& x, double payload_kg) {
    StepOutput output{};
    PlanState::Map(output.x_next.data()) = x;
    output.payload_kg = payload_kg;
    output.mean_nis = 8.0;
    follower_->Ask(sample, sample * kPeriodNs, OneMove(), output);
    planner_->Run({.due_ns = sample * kPeriodNs, .missed_in_a_row = 0});
  }

  std::optional<PlanSample> At(int sample) { return follower_->At(sample, sample * kPeriodNs); }

  PlanState StateAt(int sample) { return PlanState::Map(At(sample).value().x.data()); }

  std::unique_ptr<PlannerTask> planner_;
  std::unique_ptr<PlanFollower> follower_;
};

TEST_F(PlannerTaskTest, ThePlanHoldsFromTheBeginningOfTheMoveAndEndsAtRestAtItsGoal) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  EXPECT_FALSE(At(kFirst - 1));
  EXPECT_LT(StateAt(kFirst).norm(), 1e-12) << "at rest, and so it was predicted";
  const PlanState end = StateAt(kEnd + 19);
  EXPECT_FALSE(At(kEnd + 20));
  const std::array<double, 2> goal_rad = OneMove().moves()[0].to_rad;
  EXPECT_NEAR(end[0], goal_rad[0], 1e-3);
  EXPECT_NEAR(end[1], goal_rad[1], 1e-3);
  EXPECT_LT(end.tail<6>().cwiseAbs().maxCoeff(), 0.01);
  EXPECT_FALSE(planner_->figures().warm);
}

// On its plan the arm will be where the plan is: 5 samples with 8 steps each, where the plan
// takes 4.
TEST_F(PlannerTaskTest, TheNextPlanBeginsWhereTheArmWillBeByThen) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  const PlanState now = StateAt(kFirst + 5), then = StateAt(kFirst + 10);
  AskAt(kFirst + 5, now, 0.3);
  EXPECT_TRUE(planner_->figures().warm);
  EXPECT_LT((StateAt(kFirst + 10) - then).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_GT((then - now).cwiseAbs().maxCoeff(), 0.05) << "no motion: the test says nothing";
}

TEST_F(PlannerTaskTest, WithoutAPlanTheArmIsOnTheWayOfTheClosedForm) {
  Make();
  const RigidJointArm arm = ArmOf(DesignOfRig());
  const auto closed = [&](int k) {
    return QuasiStaticOver(arm, 0.3, PathPoints(OneMove().PathAround(k)), kPeriod_s).x;
  };
  AskAt(kFirst + 30, closed(kFirst + 30), 0.3);
  EXPECT_FALSE(planner_->figures().warm);
  // The closed form leaves out inertia of the links' bending: some 1e-3 rad over 0.1 s.
  EXPECT_LT((StateAt(kFirst + 35) - closed(kFirst + 35)).head<2>().cwiseAbs().maxCoeff(), 5e-3);
  EXPECT_GT((closed(kFirst + 35) - closed(kFirst + 30)).head<2>().cwiseAbs().maxCoeff(), 0.03);
}

TEST_F(PlannerTaskTest, AnswersARequestOnce) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  const PlanSample before = At(kFirst + 20).value();
  planner_->Run({.due_ns = (kFirst - 4) * kPeriodNs, .missed_in_a_row = 0});
  EXPECT_EQ(At(kFirst + 20)->x, before.x) << "the same plan, not one that starts from it";
}

// With a tight bound on the roughness a state that is far from the plan asks for a jump.
class RefusedPlans : public PlannerTaskTest {
 protected:
  RefusedPlans() {
    Make({"controller.plan.roughness=0.05"});
    AskAt(kFirst - 5, PlanState::Zero(), 0.3);
    kept_ = At(kFirst + 20);
    displaced_ = StateAt(kFirst + 5);
    displaced_[7] += 10.0;
  }

  std::optional<PlanSample> kept_;
  PlanState displaced_;
};

TEST_F(RefusedPlans, LeaveTheOneBeforeInForce) {
  ASSERT_TRUE(kept_);
  AskAt(kFirst + 5, displaced_, 0.31);
  ASSERT_TRUE(At(kFirst + 20));
  EXPECT_EQ(At(kFirst + 20)->x, kept_->x);
}

TEST_F(RefusedPlans, LeaveNoneIfThatIsForAnotherPayload) {
  ASSERT_TRUE(kept_);
  AskAt(kFirst + 5, displaced_, 0.6);
  EXPECT_FALSE(At(kFirst + 20));
  EXPECT_FALSE(At(kFirst + 10));
}

TEST_F(PlannerTaskTest, AnotherRunStartsFromScratch) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  follower_->Start(2);
  AskAt(kFirst + 5, PlanState::Zero(), 0.3);
  EXPECT_FALSE(planner_->figures().warm);
}

TEST_F(PlannerTaskTest, NothingAllocates) {
  Make();
  static_cast<void>(OneMove());
  const NoAlloc guard;
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  AskAt(kFirst + 5, PlanState::Zero(), 0.3);
}

}  // namespace
}  // namespace flexarm
