// The control task with a planner: when it asks for plans, and when it follows one.

#include <memory>

#include "controller/reference/motion_change.h"
#include "controller/tasks/control_task.h"
#include "tests/controller/tasks/control_task_bench.h"

namespace flexarm {
namespace {

using enum SafetyState;

class ControlPlanTest : protected PlanFollowing, public ControlTaskTest {
 protected:
  ControlPlanTest()
      : ControlTaskTest({"controller.name=gain-scheduled"}, ShippedPathDesign(), &follower) {}

  // A plan for samples 10 to 29 of a run, whose torque of joint 1 tells the sample.
  void Plan(std::uint32_t run) {
    auto motion = std::make_unique<MotionPlan>();
    motion->run = run;
    motion->number = requests->Read().number;
    motion->plan.Begin(10, 0.3);
    for (int sample = 10; sample < 30; ++sample) {
      const auto x = Eigen::Matrix<double, 12, 1>::Constant(sample);
      motion->plan.Append({.motion = MotionSample::Of(x, {1.0, 2.0}), .K = {}});
    }
    history->Push(DueNs(next_tick_), *motion);
    plans->Publish(*history);
  }
  void BeginRun(const PlannedExperiment* experiment) {
    Allow(kArmed);
    Step();
    Run(3, experiment);
  }
  std::uint32_t asked() { return requests->Read().number; }

  // From sample 10 to 110.
  const PlannedExperiment move_ = Planned(AMove(0.2, 10.0), ShippedPathDesign());
};

TEST_F(ControlPlanTest, AsksAheadOfAMoveAndFollowsThePlan) {
  BeginRun(&move_);
  Steps(5);
  EXPECT_EQ(asked(), 0U);
  const TickRecord asks = Step();
  ASSERT_EQ(asks.sample, 5);
  ASSERT_EQ(asked(), 1U);
  const PlanRequest& request = requests->Read();
  EXPECT_EQ(request.run, 3U);
  EXPECT_EQ(request.sample, 5);
  EXPECT_EQ(request.needed_ns, asks.input.now_ns + 5 * kPeriodNs);
  EXPECT_EQ(request.x[0], asks.output.x_next[0]);
  Plan(3);
  for (int sample = 6; sample < 32; ++sample) {
    const TickRecord record = Step();
    ASSERT_EQ(record.sample, sample);
    const bool planned = sample >= 10 && sample < 30;
    EXPECT_EQ(record.input.planned, planned ? 1 : 0) << sample;
    EXPECT_EQ(record.input.plan.x[0], planned ? sample : 0.0);
  }
}

TEST_F(ControlPlanTest, APlanOfAnotherRunIsNotFollowed) {
  BeginRun(&move_);
  Steps(6);
  Plan(2);
  EXPECT_EQ(Steps(6).input.planned, 0);
}

TEST_F(ControlPlanTest, StoppingFollowsNoPlan) {
  BeginRun(&move_);
  Steps(6);
  Plan(3);
  ASSERT_EQ(Steps(6).input.planned, 1);
  Allow(kStopping);
  const std::uint32_t before = asked();
  EXPECT_EQ(Steps(20).input.planned, 0);
  EXPECT_EQ(asked(), before);
}

// Plans are of the path as planned: one that was slowed does without.
TEST_F(ControlPlanTest, APathWithATimeOfItsOwnAsksForNone) {
  const PlannedExperiment slowed(
      move_, AtSpeed(move_.reference, 0.5, ShippedPathDesign(), ShippedLimits()), 0);
  ASSERT_TRUE(slowed.keeps_own_time);
  BeginRun(&slowed);
  EXPECT_EQ(Steps(60).input.planned, 0);
  EXPECT_EQ(asked(), 0U);
}

TEST_F(ControlPlanTest, ARunInOpenLoopAsksForNone) {
  const PlannedExperiment pluck(std::vector<std::array<double, 2>>(40));
  BeginRun(&pluck);
  Steps(10);
  EXPECT_EQ(asked(), 0U);
}

TEST_F(ControlPlanTest, ARunWithoutAnExperimentAsksForNone) {
  BeginRun(nullptr);
  EXPECT_EQ(Steps(10).input.planned, 0);
  EXPECT_EQ(asked(), 0U);
}

}  // namespace
}  // namespace flexarm
