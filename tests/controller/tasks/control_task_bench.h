#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "controller/tasks/control_task.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/controller/step/step_at_rest.h"
#include "tests/support/loop_time.h"

// The control task alone: permits, frames and calibrations by hand, and the records of its steps.

namespace flexarm {

/// A move of joint 1 from sample `first` on.
inline Experiment AMove(double start_s, double to_deg) {
  Experiment experiment{};
  experiment.name = "a-move";
  experiment.duration_s = 4.0;
  experiment.move.push_back({.start_s = start_s,
                             .duration_s = 2.0,
                             .to_deg = {to_deg, 0.0},
                             .profile = MoveProfile::kSeptic});
  return experiment;
}

inline PlannedExperiment Planned(const Experiment& experiment, const Design& design) {
  return {experiment, design, kPeriod_s, {0.0, 0.0}, ShippedLimits()};
}

/// The control task's side of a planner, and the channels between them. Constructed before the
/// task.
struct PlanFollowing {
  std::unique_ptr<PlanRequestChannel> requests =
      std::make_unique<PlanRequestChannel>(PlanRequest{});
  std::unique_ptr<MotionPlanHistory> history = std::make_unique<MotionPlanHistory>(MotionPlan{});
  std::unique_ptr<MotionPlanChannel> plans = std::make_unique<MotionPlanChannel>(*history);
  PlanFollower follower{
      {.every = 10, .ready = 5, .rest = 20, .period_ns = kPeriodNs}, requests.get(), plans.get()};
};

class ControlTaskTest : public testing::Test {
 protected:
  static constexpr std::int64_t kPhaseNs = 10 * kMs;    // loop.acquire_before_ms
  static constexpr std::int64_t kDeadlineNs = 5 * kMs;  // loop.step_deadline_ms
  static constexpr int kWindow = 50;                    // periods

  explicit ControlTaskTest(const std::vector<std::string>& overrides = {kThesisLaw},
                           const Design& design = ShippedDesign(), PlanFollower* planner = nullptr)
      : config_(ShippedRig(overrides)),
        step_(config_, design),
        task_(config_.loop, kWindow, &step_,
              {.frames = {&frames_[0], &frames_[1]},
               .permits = &permits_,
               .calibrations = &calibrations_,
               .commands = {&commands_[0], &commands_[1]},
               .reports = &reports_,
               .records = &records_,
               .operator_ticks = &operator_ticks_,
               .planner = planner}) {}

  static std::int64_t DueNs(std::int64_t tick) { return tick * kPeriodNs + kPhaseNs; }

  /// From a millisecond before the step on.
  void Allow(SafetyState state) {
    permit_.state = state;
    AllowFrom(DueNs(next_tick_) - kMs);
  }
  void AllowFrom(std::int64_t from_ns) {
    permit_history_.Push(from_ns, permit_);
    permits_.Publish(permit_history_);
  }
  /// A run of this number, or a change of it, from the next step on.
  void Run(std::uint32_t number, const PlannedExperiment* experiment) {
    permit_.run_number = number;
    permit_.run = {.experiment = experiment};
    permit_.change = {};
    Allow(SafetyState::kRunning);
  }
  void Change(std::uint32_t number, const PlannedExperiment* experiment) {
    permit_.change = {.number = number, .experiment = experiment};
    Allow(SafetyState::kRunning);
  }

  /// The frames of a healthy arm at rest at zero.
  FramePacket Healthy(std::int64_t tick) const {
    return {.frame = AtRest(tick, SafetyState::kIdle).frame,
            .applied_torque_nm = {},
            .gate_reasons = 0,
            .output_tick = tick - 1,
            .acted_ns = tick * kPeriodNs};
  }
  void Send(std::size_t bus, std::int64_t tick, const FramePacket& packet) {
    frame_history_[bus].Push(tick * kPeriodNs, packet);
    frames_[bus].Publish(frame_history_[bus]);
  }

  /// The next step, with these frames of the first bus.
  TickRecord Step(const FramePacket& packet, int missed_in_a_row = 0) {
    Send(0, next_tick_, packet);
    return StepWithoutFrame(missed_in_a_row);
  }
  TickRecord Step() { return Step(Healthy(next_tick_)); }
  TickRecord StepWithoutFrame(int missed_in_a_row = 0) {
    task_.Run({.due_ns = DueNs(next_tick_), .missed_in_a_row = missed_in_a_row, .late_ns = 0});
    ++next_tick_;
    TickRecord record{}, same{};
    EXPECT_TRUE(records_.Pop(&record));
    EXPECT_TRUE(operator_ticks_.Pop(&same));
    EXPECT_EQ(same.input.tick, record.input.tick);
    EXPECT_EQ(records_.size(), 0U);
    return record;
  }
  TickRecord Steps(int count) {
    TickRecord record{};
    for (int i = 0; i < count; ++i) record = Step();
    return record;
  }

  const RigConfig config_;
  ControlStep step_;
  std::array<FrameHistory, 2> frame_history_{FrameHistory(kNoFrame), FrameHistory(kNoFrame)};
  std::array<FrameChannel, 2> frames_{FrameChannel(frame_history_[0]),
                                      FrameChannel(frame_history_[1])};
  Permit permit_ = kNoPermit;
  PermitHistory permit_history_{kNoPermit};
  PermitChannel permits_{permit_history_};
  CalibrationChannel calibrations_{Calibration{}};
  std::array<CommandChannel, 2> commands_{CommandChannel(CommandHistory(kNoCommand)),
                                          CommandChannel(CommandHistory(kNoCommand))};
  ControlReportChannel reports_{ControlReportHistory(kNoControlReport)};
  SpscQueue<TickRecord> records_{8};
  SpscQueue<TickRecord> operator_ticks_{8};
  ControlTask task_;
  std::int64_t next_tick_ = 0;
};

}  // namespace flexarm
