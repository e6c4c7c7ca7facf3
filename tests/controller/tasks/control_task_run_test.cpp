// A run in the control task: which reference a step gets, sample by sample.

#include "controller/reference/motion_change.h"
#include "controller/tasks/control_task.h"
#include "tests/controller/tasks/control_task_bench.h"

namespace flexarm {
namespace {

using enum SafetyState;

class ControlRunTest : public ControlTaskTest {
 protected:
  using ControlTaskTest::ControlTaskTest;

  void Arm() {
    Allow(kIdle);
    Step();
    Allow(kArmed);
    Step();
  }

  const PlannedExperiment move_ = Planned(AMove(0.2, 10.0), ShippedDesign());
};

TEST_F(ControlRunTest, BeginsWithItsFirstSampleAndAReset) {
  Arm();
  Run(5, &move_);
  for (int k = 0; k < 60; ++k) {
    const TickRecord record = Step();
    EXPECT_EQ(record.run_number, 5U);
    EXPECT_EQ(record.change_number, 0U);
    EXPECT_EQ(record.sample, k);
    EXPECT_EQ(record.input.reset, k == 0 ? 1 : 0);
    EXPECT_EQ(record.input.mode, LoopMode::kFollow);
    EXPECT_EQ(record.input.planned, 0);
    EXPECT_EQ(record.input.reference_next.x_m[0], move_.reference.At(k).x_m[0]);
    EXPECT_EQ(record.input.reference_ended, 0);
  }
  EXPECT_GT(move_.reference.At(59).x_m[0], 0.01) << "the reference moves by then";
  EXPECT_EQ(task_.released(), 5U);
}

TEST_F(ControlRunTest, EndsWithItsLastPeriod) {
  Arm();
  Run(1, &move_);
  const int periods = move_.reference.periods();
  for (int k = 0; k < periods - 1; ++k) ASSERT_EQ(Step().input.reference_ended, 0) << k;
  const TickRecord last = Step();
  EXPECT_EQ(last.sample, periods - 1);
  EXPECT_EQ(last.input.reference_ended, 1);
}

// Stopping holds the sample that the run has reached: rest there, or at the end.
TEST_F(ControlRunTest, AStopKeepsTheSample) {
  Arm();
  Run(1, &move_);
  Steps(40);
  Allow(kStopping);
  const TickRecord stopping = Steps(3);
  EXPECT_EQ(stopping.sample, 39);
  EXPECT_EQ(stopping.input.reference_next.x_m[0], move_.reference.At(39).x_m[0]);
}

TEST_F(ControlRunTest, AStopInTheLastPeriodIsAtRestAfterTheEnd) {
  Arm();
  Run(1, &move_);
  const int periods = move_.reference.periods();
  Steps(periods - 1);
  Allow(kStopping);
  EXPECT_EQ(Step().sample, periods - 2) << "the last period has not begun";
  Allow(kRunning);
  Step();
  Allow(kStopping);
  EXPECT_EQ(Step().sample, periods);
  EXPECT_EQ(Step().sample, periods) << "and stays there";
}

TEST_F(ControlRunTest, ARunWithoutAnExperimentEndsAtOnceWhereTheHubsAre) {
  FramePacket turned = Healthy(0);
  turned.frame.counter = {100, 60, 100, 60};
  const TickRecord idle = Step(turned);
  Run(2, nullptr);
  turned.frame.sampled_at_ns = kPeriodNs;
  const StepInput input = Step(turned).input;
  EXPECT_EQ(input.reference_ended, 1);
  for (const std::size_t joint : {std::size_t{0}, std::size_t{1}}) {
    EXPECT_NE(idle.output.angle_rad[joint], 0.0);
    EXPECT_EQ(input.reference_now.x_m[joint], idle.output.angle_rad[joint]);
    EXPECT_EQ(input.reference_next.x_m[joint], idle.output.angle_rad[joint]);
  }
}

TEST_F(ControlRunTest, WithoutTorqueThereIsNoReference) {
  Arm();
  Run(1, &move_);
  Steps(40);
  Allow(kArmed);
  const TickRecord armed = Step();
  EXPECT_EQ(armed.input.reference_next.x_m[0], 0.0);
  EXPECT_EQ(armed.run_number, 1U) << "the last one";
}

TEST_F(ControlRunTest, TheNextRunBeginsFromTheStart) {
  Arm();
  Run(1, &move_);
  Steps(40);
  Allow(kArmed);
  Step();
  const PlannedExperiment other = Planned(AMove(0.0, -20.0), ShippedDesign());
  Run(2, &other);
  const TickRecord first = Step();
  EXPECT_EQ(first.sample, 0);
  EXPECT_EQ(first.input.reset, 1);
  EXPECT_EQ(first.run_number, 2U);
  EXPECT_EQ(task_.released(), 2U);
  EXPECT_EQ(Steps(20).input.reference_next.x_m[0], other.reference.At(20).x_m[0]);
}

// The old path until the first sample of the new one, so that nothing jumps.
TEST_F(ControlRunTest, AChangeIsFollowedFromItsSampleOn) {
  const PlannedExperiment changed(
      move_,
      ReferenceTable(AMove(0.2, 11.0), ShippedDesign(), kPeriod_s, {0.0, 0.0}, ShippedLimits()),
      30);
  Arm();
  Run(1, &move_);
  Steps(10);
  Change(4, &changed);
  const TickRecord record = Step();
  EXPECT_EQ(record.change_number, 4U);
  EXPECT_EQ(record.run_number, 1U);
  EXPECT_EQ(record.sample, 10) << "the run goes on";
  EXPECT_EQ(record.input.reset, 0);
  EXPECT_EQ(task_.released(), 4U);
  EXPECT_EQ(Steps(30).input.reference_next.x_m[0], changed.reference.At(40).x_m[0]);
  EXPECT_NE(changed.reference.At(40).x_m[0], move_.reference.At(40).x_m[0]);
  Allow(kArmed);
  Step();
  Run(7, &move_);
  EXPECT_EQ(Step().change_number, 0U) << "a new run has none";
}

// The torque is computed ahead, and the delay may grow: half of kChangeLead must be left.
TEST_F(ControlRunTest, AChangeThatComesTooLateIsLeftOut) {
  const ReferenceTable table(AMove(0.2, 11.0), ShippedDesign(), kPeriod_s, {0.0, 0.0},
                             ShippedLimits());
  constexpr int kAt = 12;  // sample in whose step the change is seen: of the step before
  for (const bool in_time : {true, false}) {
    const int sample_before = kAt - 1;
    const PlannedExperiment changed(move_, table,
                                    sample_before + kChangeLead / 2 + (in_time ? 1 : 0));
    Allow(kArmed);
    Step();
    const std::uint32_t run = in_time ? 1 : 11;
    Run(run, &move_);
    Steps(kAt);
    Change(run + 1, &changed);
    const TickRecord record = Step();
    EXPECT_EQ(record.sample, kAt);
    EXPECT_EQ(record.change_number, in_time ? run + 1 : 0U);
    EXPECT_EQ(task_.released(), in_time ? run + 1 : run);
  }
}

TEST_F(ControlRunTest, APermitWithoutAChangeChangesNothing) {
  Arm();
  Run(1, &move_);
  Steps(3);
  Change(2, nullptr);
  EXPECT_EQ(Step().change_number, 0U);
  EXPECT_EQ(task_.released(), 1U);
}

TEST_F(ControlRunTest, TorquesInOpenLoopArePutOutOnceEach) {
  const PlannedExperiment pluck({{0.5, 0.0}, {-0.5, 0.1}, {0.25, 0.0}});
  Arm();
  Run(1, &pluck);
  for (const double torque_nm : {0.5, -0.5, 0.25}) {
    const TickRecord record = Step();
    EXPECT_EQ(record.input.mode, LoopMode::kOpenLoop);
    EXPECT_EQ(record.input.reference_next.u_m_nm[0], torque_nm);
    EXPECT_EQ(record.output.torque_nm[0], torque_nm);
  }
  EXPECT_EQ(commands_[1].Read().Newest().value.torque_nm[0], 0.25);
}

TEST_F(ControlRunTest, HomingSearchesFromWhereTheHubsAre) {
  FramePacket turned = Healthy(0);
  turned.frame.counter[0] = 100;
  turned.frame.counter[2] = 100;
  const double hub_rad = Step(turned).output.angle_rad[0];
  const PlannedExperiment homing(HomingPlan{.line = Line::kLimit1High,
                                            .joint = 0,
                                            .step_rad = 0.001,
                                            .travel_rad = 1.0,
                                            .back_rad = 0.0025});
  Run(1, &homing);
  const auto step = [&] {
    turned.frame.sampled_at_ns = next_tick_ * kPeriodNs;
    return Step(turned).input;
  };
  StepInput input = step();
  EXPECT_EQ(input.mode, LoopMode::kRegulate);
  EXPECT_DOUBLE_EQ(input.reference_next.x_m[0], hub_rad + 0.001);
  EXPECT_EQ(input.reference_ended, 0);
  permit_.levels = kHealthyLevels & ~LineBit(Line::kLimit1High);
  Allow(kRunning);
  input = step();
  EXPECT_DOUBLE_EQ(input.reference_next.x_m[0], hub_rad - 0.001) << "the switch is open: back";
  EXPECT_EQ(input.reference_ended, 0);
  step();
  EXPECT_EQ(step().reference_ended, 1);
}

class PathRunTest : public ControlRunTest {
 protected:
  PathRunTest() : ControlRunTest({"controller.name=gain-scheduled"}, ShippedPathDesign()) {}
};

// A paused run stays at its sample until its path is changed again.
TEST_F(PathRunTest, APausedRunHoldsItsSample) {
  const PlannedExperiment path = Planned(AMove(0.0, 10.0), ShippedPathDesign());
  constexpr int kFrom = 20;
  const PlannedExperiment paused(
      path, WithSpeed(path.reference, kFrom, 0.0, ShippedPathDesign(), ShippedLimits()), kFrom);
  Arm();
  Run(1, &path);
  Steps(5);
  Change(2, &paused);
  const int holds_at = paused.reference.holds_at();
  ASSERT_LT(holds_at, 1000);
  EXPECT_EQ(Steps(holds_at - 4).sample, holds_at);
  EXPECT_EQ(Steps(5).sample, holds_at);
}

}  // namespace
}  // namespace flexarm
