// The planner task: its plan for a request. That plans bring the tip to rest is shown in
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

  // Requests a plan at a sample and runs the planner.
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

  std::optional<MotionSample> At(int sample) { return follower_->At(sample, sample * kPeriodNs); }

  PlanState StateAt(int sample) { return At(sample).value().State(); }

  // State of an arm with 0.3 kg five samples after x, under the law that follows desired(sample).
  // Without friction: the law's friction feedforward is assumed to cancel it.
  template <typename Desired>
  PlanState FiveSamplesAfter(int sample, const PlanState& x, const Desired& desired) {
    const RigidJointArm arm = MakeRigidJointArm(DesignOfRig());
    const ScheduledLaw law(arm, DesignOfRig().scheduled->gains, BendingGuard(ShippedRig()), 1.0,
                           kPeriod_s, {30.0, 6.0});
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

  static MotionSample ClosedForm(int sample) {
    return QuasiStaticOver(MakeRigidJointArm(DesignOfRig()), 0.3, OneMove().PathAround(sample),
                           kPeriod_s);
  }

  std::unique_ptr<PlannerTask> planner_;
  std::unique_ptr<PlanFollower> follower_;
};

TEST_F(PlannerTaskTest, ThePlanStartsWithTheMoveAndEndsAtRestAtItsGoal) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  EXPECT_FALSE(At(kFirst - 1));
  EXPECT_LT(StateAt(kFirst).norm(), 1e-12) << "predicted at rest";
  const PlanState end = StateAt(kEnd + 19);
  EXPECT_FALSE(At(kEnd + 20));
  const std::array<double, 2> goal_rad = OneMove().moves()[0].to_rad;
  EXPECT_NEAR(end[0], goal_rad[0], 1e-3);
  EXPECT_NEAR(end[1], goal_rad[1], 1e-3);
  EXPECT_LT(end.tail<6>().cwiseAbs().maxCoeff(), 0.01);
  EXPECT_FALSE(planner_->figures().warm);
}

// The planner uses each number of the config: the plan is that of a planner with the design study's
// settings.
TEST_F(PlannerTaskTest, PlansWithTheWeightsAndLimitsOfTheConfig) {
  for (const double torque_share : {0.93, 0.05}) {
    Make({"controller.plan.torque_share=" + std::to_string(torque_share),
          "controller.plan.roughness=2"});
    AskAt(kFirst - 5, PlanState::Zero(), 0.3);
    HorizonPlannerConfig config = StudyPlannerConfig();
    config.torque_limit_nm = {torque_share * 30.0, torque_share * 6.0};
    config.roughness = 2.0;
    const auto planner = std::make_unique<HorizonPlanner>(
        MakeRigidJointArm(DesignOfRig()), kPeriod_s, *DesignOfRig().scheduled->start_gains, config);
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
      ASSERT_EQ(StateAt(k), expected.motion.State()) << k;
      largest =
          std::max(largest, std::fabs(expected.motion.torque_nm[1]) / config.torque_limit_nm[1]);
    }
    EXPECT_EQ(largest == 1.0, torque_share < 0.1) << "only the second plan reaches the limit";
  }
}

// Due when the step has published, 15 ms after its sample; a plan requested at one step is valid
// for the fifth after it.
TEST_F(PlannerTaskTest, IsDueAfterTheStepAndReadyBeforeThePlanIsValid) {
  Make();
  const Task::Traits traits = planner_->traits();
  EXPECT_EQ(traits.phase_ns, 15'000'000);
  EXPECT_EQ(traits.period_ns, kPeriodNs);
  EXPECT_EQ(traits.deadline_ns, 4 * kPeriodNs);
}

// For an arm that follows its plan the predicted state is that of the plan, up to the integration
// error: the prediction takes 8 steps a sample, the plan 4.
TEST_F(PlannerTaskTest, TheNextPlanStartsAtThePredictedState) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  const PlanState now = StateAt(kFirst + 5), then = StateAt(kFirst + 10);
  AskAt(kFirst + 5, now, 0.3);
  EXPECT_TRUE(planner_->figures().warm);
  EXPECT_LT((StateAt(kFirst + 10) - then).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_GT((then - now).cwiseAbs().maxCoeff(), 0.05) << "no motion: the test is inconclusive";
}

TEST_F(PlannerTaskTest, TheOldPlanIsValidUntilTheNextOneIs) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  const PlanState before = StateAt(kFirst + 9);
  AskAt(kFirst + 5, StateAt(kFirst + 5), 0.3);
  ASSERT_TRUE(At(kFirst + 9));
  EXPECT_EQ(StateAt(kFirst + 9), before);
}

// The new plan starts at the state predicted under the law, up to round-off.
TEST_F(PlannerTaskTest, ThePredictionFollowsTheOldPlanUntilTheNextOneIsValid) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  PlanState beside = StateAt(kFirst + 5);
  beside[0] += 0.02;
  const PlanState expected =
      FiveSamplesAfter(kFirst + 5, beside, [this](int k) { return At(k).value(); });
  AskAt(kFirst + 5, beside, 0.3);
  EXPECT_LT((StateAt(kFirst + 10) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

// The plan of the run before is for another payload, and would give another prediction.
TEST_F(PlannerTaskTest, InAnotherRunThePredictionUsesTheClosedForm) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.8);
  follower_->Start(2);
  const PlanState beside = ClosedForm(kFirst + 5).State() + PlanState::Constant(1e-3);
  AskAt(kFirst + 5, beside, 0.3);
  const PlanState expected = FiveSamplesAfter(kFirst + 5, beside, ClosedForm);
  EXPECT_LT((StateAt(kFirst + 10) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(PlannerTaskTest, AfterAModelMismatchThePredictionUsesTheClosedForm) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.31);
  const PlanState beside = ClosedForm(kFirst + 5).State() + PlanState::Constant(1e-3);
  AskAt(kFirst + 5, beside, 0.3, kPayloadModelMismatch);
  EXPECT_FALSE(planner_->figures().warm);
  const PlanState expected = FiveSamplesAfter(kFirst + 5, beside, ClosedForm);
  EXPECT_LT((StateAt(kFirst + 10) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(PlannerTaskTest, WithoutAPlanThePredictionFollowsTheClosedForm) {
  Make();
  const auto closed = [](int k) { return ClosedForm(k).State(); };
  AskAt(kFirst + 30, closed(kFirst + 30), 0.3);
  EXPECT_FALSE(planner_->figures().warm);
  // The closed form neglects the inertia of the links' bending: some 1e-3 rad over 0.1 s.
  EXPECT_LT((StateAt(kFirst + 35) - closed(kFirst + 35)).head<2>().cwiseAbs().maxCoeff(), 5e-3);
  EXPECT_GT((closed(kFirst + 35) - closed(kFirst + 30)).head<2>().cwiseAbs().maxCoeff(), 0.03);
}

TEST_F(PlannerTaskTest, AnswersARequestOnce) {
  Make();
  AskAt(kFirst - 5, PlanState::Zero(), 0.3);
  const MotionSample before = At(kFirst + 20).value();
  planner_->Run({.due_ns = (kFirst - 4) * kPeriodNs, .missed_in_a_row = 0});
  EXPECT_EQ(At(kFirst + 20)->x, before.x) << "the same plan, and not another warm start";
}

// With a tight bound on the roughness a state far from the plan needs a larger jump than allowed.
class RefusedPlans : public PlannerTaskTest {
 protected:
  RefusedPlans() {
    Make({"controller.plan.roughness=0.05"});
    AskAt(kFirst - 5, PlanState::Zero(), 0.3);
    kept_ = At(kFirst + 20);
    displaced_ = StateAt(kFirst + 5);
    displaced_[7] += 10.0;
  }

  std::optional<MotionSample> kept_;
  PlanState displaced_;
};

TEST_F(RefusedPlans, LeaveThePreviousPlanValid) {
  ASSERT_TRUE(kept_);
  AskAt(kFirst + 5, displaced_, 0.31);
  ASSERT_TRUE(At(kFirst + 20));
  EXPECT_EQ(At(kFirst + 20)->x, kept_->x);
}

TEST_F(RefusedPlans, LeaveNoPlanIfThePreviousIsForAnotherPayload) {
  ASSERT_TRUE(kept_);
  AskAt(kFirst + 5, displaced_, 0.6);
  EXPECT_FALSE(At(kFirst + 20));
  EXPECT_FALSE(At(kFirst + 10));
}

// A fifth of 0.05 kg is less than the difference of 0.03 kg that is always allowed.
TEST_F(PlannerTaskTest, ARefusedPlanForALightPayloadLeavesThePreviousToo) {
  Make({"controller.plan.roughness=0.05"});
  AskAt(kFirst - 5, PlanState::Zero(), 0.05);
  PlanState displaced = StateAt(kFirst + 5);
  displaced[7] += 10.0;
  AskAt(kFirst + 5, displaced, 0.07);
  EXPECT_TRUE(At(kFirst + 20));
}

// The roughness includes the jump from the torque that acts before the plan, not from zero.
TEST_F(PlannerTaskTest, APlanThatStartsDuringAMoveIsNotRough) {
  Make({"controller.plan.roughness=0.05"});
  AskAt(kFirst + 20, ClosedForm(kFirst + 20).State(), 0.3);
  ASSERT_TRUE(At(kFirst + 25));
  const std::array<double, 2> torque_nm = At(kFirst + 25)->torque_nm;
  EXPECT_GT(std::fabs(torque_nm[0]) / 28.0 + std::fabs(torque_nm[1]) / 5.6, 0.06)
      << "the test is inconclusive";
}

TEST_F(PlannerTaskTest, ThePlanOfAnotherRunIsNoWarmStart) {
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
