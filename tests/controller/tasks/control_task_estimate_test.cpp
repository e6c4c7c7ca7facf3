// What the control task does with the estimates of its last step: the delay found shifts the
// reference and the plans, and the payload found chooses the duration of a move.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "controller/reference/timed_reference.h"
#include "controller/tasks/control_task.h"
#include "controller/types/known_payload.h"
#include "tests/controller/loop/stack_run.h"
#include "tests/controller/tasks/control_task_bench.h"

namespace flexarm {
namespace {

using enum SafetyState;

// The simulated transport has a delay that is not declared to the loop.
const std::vector<std::string> kDelayedArm = {"controller.name=gain-scheduled",
                                              "sim.transport_delay_ms=20"};
constexpr double kPayload_kg = 0.2;

// The second move is as short as the payload allows that was found in the first.
Experiment TwoMoves() {
  Experiment experiment = ShippedExperiment("fast-moves");
  experiment.move.resize(2);
  experiment.duration_s = 8.0;
  return experiment;
}

// The control task with the readings of a simulated arm.
class ControlEstimateTest : protected PlanFollowing, public ControlTaskTest {
 protected:
  static void SetUpTestSuite() {
    arm_ = std::make_unique<StackRun>(ShippedRig(kDelayedArm), TwoMoves(), kPayload_kg);
    arm_->Run(9'000'000'000);
  }
  static void TearDownTestSuite() { arm_.reset(); }

  ControlEstimateTest() : ControlTaskTest(kDelayedArm, arm_->design(), &follower) {}

  // The next step, in the state and with the readings that the arm had.
  TickRecord StepOfTheArm() {
    const StepInput& input = arm_->tick.at(static_cast<std::size_t>(next_tick_)).input;
    if (input.safety_state == kRunning) {
      Run(1, &moves_);
    } else {
      Allow(input.safety_state);
    }
    return Step({.frame = input.frame,
                 .applied_torque_nm = input.applied_torque_nm,
                 .gate_reasons = 0,
                 .output_tick = next_tick_ - 1,
                 .acted_ns = input.sampling_instant_ns + input.acted_late_ns});
  }
  bool ArmRuns() const { return !IsOver() && StateOfTheArm() == kRunning; }
  bool IsOver() const { return static_cast<std::size_t>(next_tick_) == arm_->tick.size(); }
  SafetyState StateOfTheArm() const {
    return arm_->tick.at(static_cast<std::size_t>(next_tick_)).input.safety_state;
  }
  TickRecord UntilTheRun() {
    TickRecord record{};
    while (!ArmRuns()) record = StepOfTheArm();
    return record;
  }

  static std::unique_ptr<StackRun> arm_;
  const PlannedExperiment moves_ = Planned(TwoMoves(), arm_->design());
};

std::unique_ptr<StackRun> ControlEstimateTest::arm_;

TEST_F(ControlEstimateTest, ThePathIsThatOfTheDelayAndThePayloadFound) {
  TickRecord before = UntilTheRun();
  TimedReference expected;
  expected.Start(&moves_.reference, &moves_.load_change);
  int delayed = 0, shorter = 0;
  while (ArmRuns()) {
    const TickRecord record = StepOfTheArm();
    const int acts = record.sample + before.output.delay_found;
    expected.Choose(acts, KnownPayload(before.output));
    const std::array<RigidPoint, 3> path = expected.PathAround(acts);
    ASSERT_EQ(record.input.path[1].angle_rad, path[1].angle_rad) << record.sample;
    ASSERT_EQ(record.input.path[1].rate_rad_s, path[1].rate_rad_s) << record.sample;
    delayed += before.output.delay_found != 0 ? 1 : 0;
    shorter += path[1].angle_rad != moves_.reference.PathAround(acts)[1].angle_rad ? 1 : 0;
    before = record;
  }
  EXPECT_GT(delayed, 200) << "found in the first move";
  EXPECT_GT(shorter, 20) << "the second move is not as in the table";
}

TEST_F(ControlEstimateTest, PlansAreAskedForAndReadAtTheSampleOfTheDelayFound) {
  TickRecord before = UntilTheRun();
  auto motion = std::make_unique<MotionPlan>();  // its state tells the sample
  motion->run = 1;
  int delayed_requests = 0, delayed_plans = 0;
  std::uint32_t asked = 0;
  while (ArmRuns()) {
    const TickRecord record = StepOfTheArm();
    if (record.input.planned != 0) {
      EXPECT_EQ(record.input.plan.x[0], record.sample + before.output.delay_found);
      delayed_plans += before.output.delay_found != 0 ? 1 : 0;
    }
    before = record;
    const PlanRequest& request = requests->Read();
    if (request.number == asked) continue;
    asked = request.number;
    EXPECT_EQ(request.sample, record.sample + record.output.delay_found);
    delayed_requests += record.output.delay_found != 0 ? 1 : 0;
    motion->number = asked;
    motion->plan.Begin(request.first, kPayload_kg);
    for (int k = request.first; k < request.first + 20; ++k) {
      const auto x = Eigen::Matrix<double, 12, 1>::Constant(k);
      motion->plan.Append({.motion = MotionSample::Of(x, {0.0, 0.0}), .K = {}});
    }
    history->Push(DueNs(next_tick_) - 1, *motion);
    plans->Publish(*history);
  }
  EXPECT_GT(delayed_requests, 5);
  EXPECT_GT(delayed_plans, 50);
}

TEST_F(ControlEstimateTest, ANewRunBeginsWithoutTheDelayFound) {
  TickRecord last = UntilTheRun();
  while (ArmRuns()) last = StepOfTheArm();
  ASSERT_EQ(last.output.delay_found, 1);
  Allow(kArmed);
  Step();
  const PlannedExperiment next = Planned(AMove(0.0, 20.0), arm_->design());
  Run(2, &next);
  const TickRecord first = Step();
  ASSERT_EQ(first.sample, 0);
  EXPECT_EQ(first.output.delay_found, 0);
  EXPECT_EQ(first.input.path[2].angle_rad, next.reference.PathAround(0)[2].angle_rad);
  EXPECT_NE(first.input.path[2].angle_rad, next.reference.PathAround(1)[2].angle_rad);
}

}  // namespace
}  // namespace flexarm
