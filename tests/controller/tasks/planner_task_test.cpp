// The planner's thread: what it makes of a request. That plans bring the tip to rest is shown in
// tests/controller/planner/horizon_planner_test.cpp.

#include "controller/tasks/planner_task.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "controller/design/design_controller.h"
#include "controller/reference/path_reference.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"
#include "tests/support/no_alloc.h"
#include "tests/support/study_planner.h"

namespace flexarm {
namespace {

constexpr int kFirst = 50, kEnd = 150;  // of the move

RigConfig Rig(const std::vector<std::string>& overrides = {}) {
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
    const RigConfig config = Rig(overrides);
    planner_ = std::make_unique<PlannerTask>(config, DesignOfRig());
    follower_ = std::make_unique<PlanFollower>(PlanScheduleOf(config), &planner_->requests(),
                                               &planner_->plans());
    follower_->Start(1);
  }

  // The control task asks at a sample, and the planner runs.
  void AskAt(int sample, const PlanState& x, double payload_kg, std::uint32_t warnings = 0) {
    StepOutput output{};
    output.payload_warnings = warnings;
    PlanState::Map(output.x_next.data()) = x;
    output.payload_kg = payload_kg;
    output.mean_nis = 8.0;
    output.friction_nm = {0.16, 0.01};
    follower_->Ask(sample, sample * kPeriodNs, OneMove(), output);
    planner_->Run({.due_ns = sample * kPeriodNs, .missed_in_a_row = 0});
  }

  std::optional<PlanSample> At(int sample) { return follower_->At(sample, sample * kPeriodNs); }

  PlanState StateAt(int sample) { return PlanState::Map(At(sample).value().x.data()); }

  // Where an arm with 0.3 kg will be five samples after it was at x, under the law towards
  // desired(sample). Without friction: what the law feeds forward against it, it takes.
  template <typename Desired>
  PlanState FiveSamplesAfter(int sample, const PlanState& x, const Desired& desired) {
    const RigidJointArm arm = MakeRigidJointArm(DesignOfRig());
    const ScheduledLaw law(arm, DesignOfRig().scheduled->gains, kPeriod_s, {30.0, 6.0});
    const RigidJointStepper stepper(arm, kPeriod_s, 1.0);
    const PayloadKnowledge known{.payload_kg = 0.3,
                                 .payload_sigma_kg = 0.0,
                                 .friction_nm = {0.0, 0.0},
                                 .mean_nis = 8.0,
                                 .warnings = 0};
    GaugedState at{.q = x.head<6>(), .v = x.tail<6>(), .phi_f = Eigen::Vector4d::Zero()};
    for (int k = sample; k < sample + 5; ++k) {
      const PlanState now = (PlanState() << at.q, at.v).finished();
      const Eigen::Vector2d torque_nm = law.Torque(now, known, desired(k), 0.0);
      at = stepper.Advance(at,
                           {.torque_nm = torque_nm, .payload_kg = 0.3, .friction_nm = {0.0, 0.0}});
    }
    return (PlanState() << at.q, at.v).finished();
  }

  static QuasiStaticSample ClosedForm(int sample) {
    return QuasiStaticOver(MakeRigidJointArm(DesignOfRig()), 0.3, OneMove().PathAround(sample),
                           kPeriod_s);
  }

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

// Each number of the config in its place: the plan is that of a planner which was told the design
// study's.
TEST_F(PlannerTaskTest, PlansWithTheWeightsAndLimitsOfTheConfig) {
  for (const double torque_share : {0.93, 0.05}) {
    Make({"controller.plan.torque_share=" + std::to_string(torque_share),
          "controller.plan.roughness=2"});
    AskAt(kFirst - 5, PlanState::Zero(), 0.3);
    HorizonPlannerConfig told = StudyPlannerConfig();
    told.torque_limit_nm = {torque_share * 30.0, torque_share * 6.0};
    told.roughness = 2.0;
    const auto planner = std::make_unique<HorizonPlanner>(
        MakeRigidJointArm(DesignOfRig()), kPeriod_s, *DesignOfRig().scheduled->start_gains, told);
    std::vector<RigidPoint> path;
    for (int k = kFirst - 1; k <= kEnd + 21; ++k) {
      path.push_back(OneMove().PathAround(k)[1]);
    }
    const auto plan = std::make_unique<HorizonPlan>();
    ASSERT_TRUE(planner->Plan({.first_tick = kFirst,
                               .x = PlanState::Zero(),
                               .payload_kg = 0.3,
                               .torque_before_nm = {0.0, 0.0},
                               .path = path,
                               .move_samples = kEnd - kFirst},
                              nullptr, plan.get()));
    double largest = 0.0;
    for (int k = kFirst; k < kEnd + 20; ++k) {
      const PlanEntry expected = plan->At(k).value();
      ASSERT_EQ(StateAt(k), expected.x) << k;
      largest = std::max(largest, std::fabs(expected.torque_nm[1]) / told.torque_limit_nm[1]);
    }
    EXPECT_EQ(largest == 1.0, torque_share < 0.1) << "the limit counts in the second plan only";
  }
}

// Due when the step has published, 15 ms after its sample; what was asked for at one step holds for
// the fifth after it.
TEST_F(PlannerTaskTest, IsDueWhenAStepHasAskedAndReadyBeforeThePlanHolds) {
  Make();
  const Task::Traits traits = planner_->traits();
  EXPECT_EQ(traits.phase_ns, 15'000'000);
  EXPECT_EQ(traits.period_ns, kPeriodNs);
  EXPECT_EQ(traits.deadline_ns, 4 * kPeriodNs);
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

TEST_F(PlannerTaskTest, TheOldPlanHoldsUntilTheNextOneDoes) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  const PlanState before = StateAt(kFirst + 9);
  AskAt(kFirst + 5, StateAt(kFirst + 5), 0.3);
  ASSERT_TRUE(At(kFirst + 9));
  EXPECT_EQ(StateAt(kFirst + 9), before);
}

// Round-off only: the plan begins where the law will have taken the arm.
TEST_F(PlannerTaskTest, AnArmBesideItsPlanIsLedBackByTheLawUntilTheNextOneHolds) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  PlanState beside = StateAt(kFirst + 5);
  beside[0] += 0.02;
  const PlanState expected = FiveSamplesAfter(kFirst + 5, beside, [this](int k) {
    const PlanSample plan = At(k).value();
    return QuasiStaticSample{.x = PlanState::Map(plan.x.data()),
                             .torque_nm = Eigen::Vector2d::Map(plan.torque_nm.data())};
  });
  AskAt(kFirst + 5, beside, 0.3);
  EXPECT_LT((StateAt(kFirst + 10) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

// The plan of the run before is for an arm of another payload, and would lead it elsewhere.
TEST_F(PlannerTaskTest, InAnotherRunItIsLedByTheClosedForm) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.8);
  follower_->Start(2);
  const PlanState beside = ClosedForm(kFirst + 5).x + PlanState::Constant(1e-3);
  AskAt(kFirst + 5, beside, 0.3);
  const PlanState expected = FiveSamplesAfter(kFirst + 5, beside, ClosedForm);
  EXPECT_LT((StateAt(kFirst + 10) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(PlannerTaskTest, WhereTheModelIsContradictedTheOldPlanIsNoGuide) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.31);
  const PlanState beside = ClosedForm(kFirst + 5).x + PlanState::Constant(1e-3);
  AskAt(kFirst + 5, beside, 0.3, kPayloadModelMismatch);
  EXPECT_FALSE(planner_->figures().warm);
  const PlanState expected = FiveSamplesAfter(kFirst + 5, beside, ClosedForm);
  EXPECT_LT((StateAt(kFirst + 10) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(PlannerTaskTest, WithoutAPlanTheArmIsOnTheWayOfTheClosedForm) {
  Make();
  const auto closed = [](int k) { return ClosedForm(k).x; };
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

// A fifth of 0.05 kg is less than the 0.03 kg that a plan may always be off by.
TEST_F(PlannerTaskTest, ARefusedPlanForALightPayloadLeavesTheOneBeforeToo) {
  Make({"controller.plan.roughness=0.05"});
  AskAt(kFirst - 5, PlanState::Zero(), 0.05);
  PlanState displaced = StateAt(kFirst + 5);
  displaced[7] += 10.0;
  AskAt(kFirst + 5, displaced, 0.07);
  EXPECT_TRUE(At(kFirst + 20));
}

// Rough is what jumps from the torque that acts before the plan does, not from nothing.
TEST_F(PlannerTaskTest, APlanMadeInMidMoveIsNoJump) {
  Make({"controller.plan.roughness=0.05"});
  AskAt(kFirst + 20, ClosedForm(kFirst + 20).x, 0.3);
  ASSERT_TRUE(At(kFirst + 25));
  const std::array<double, 2> torque_nm = At(kFirst + 25)->torque_nm;
  EXPECT_GT(std::fabs(torque_nm[0]) / 28.0 + std::fabs(torque_nm[1]) / 5.6, 0.06) << "no test";
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
