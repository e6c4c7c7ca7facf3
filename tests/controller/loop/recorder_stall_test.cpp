#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "controller/host/run_info.h"
#include "controller/runlog/recorder_task.h"
#include "controller/runlog/run_writer.h"
#include "tests/controller/loop/stack_run.h"

// A disk that stands still, or is full, while the arm runs: with the queues of the daemon, in lock
// step.

namespace flexarm {
namespace {

constexpr std::int64_t kStallSecond = 1'000'000'000;

// The recorder, which a disk holds up from one instant to another.
class HeldUp final : public Task {
 public:
  HeldUp(RecorderTask* recorder, std::int64_t from_ns, std::int64_t until_ns)
      : recorder_(recorder), from_ns_(from_ns), until_ns_(until_ns) {}
  Traits traits() const noexcept override { return recorder_->traits(); }
  void Run(const Activation& activation) noexcept override {
    if (activation.due_ns < from_ns_ || activation.due_ns >= until_ns_) recorder_->Run(activation);
  }

 private:
  RecorderTask* recorder_;
  std::int64_t from_ns_, until_ns_;
};

// A disk that is full after some ticks.
class FullDisk final : public RunMemory {
 public:
  FullDisk(RunContents* contents, std::size_t ticks) : RunMemory(contents), left_(ticks) {}
  void Tick(const TickRecord& record) override {
    if (left_-- == 0) throw std::runtime_error("database or disk is full");
    RunMemory::Tick(record);
  }

 private:
  std::size_t left_;
};

// Longer than any of the tests.
constexpr const char* kLongMove =
    "name = \"long\"\nduration_s = 310.0\n"
    "[[move]]\nstart_s = 0.0\nduration_s = 1.8\nto_deg = [10.0, -10.0]\n";

// The shipped rig, armed after a second and running from 1.2 s on, with its recorder.
class RecordedArm {
 public:
  explicit RecordedArm(std::int64_t stall_ns, OpenSink open)
      : planned_(ParseExperiment(kLongMove, "long"), ShippedDesign(),
                 LoopGrid(config_.loop).period_s(), {0.0, 0.0}, MotionLimitsOf(config_)),
        stack_(config_, config_, ShippedDesign(), 0.1),
        recording_(MakeRunInfo(config_, ShippedDesign(), "simulated", "sim"), std::move(open),
                   [this](bool is_error, const std::string& text) {
                     if (is_error) errors.push_back(text);
                   }),
        recorder_({.ticks = &stack_.tick_records(),
                   .safety = &stack_.safety_records(),
                   .timing = &timing_,
                   .events = &events_},
                  &recording_),
        held_up_(&recorder_, 2 * kStallSecond, 2 * kStallSecond + stall_ns) {
    for (Task* task : stack_.tasks()) executor_.Add(*task);
    executor_.Add(held_up_);
  }

  void Run(std::int64_t end_ns) {
    stack_.requests().Push(
        {.kind = RequestKind::kArm, .number = 1, .not_before_ns = kStallSecond, .run = {}});
    executor_.RunUntil(kStallSecond + kStallSecond / 5);
    stack_.requests().Push({.kind = RequestKind::kRun,
                            .number = 2,
                            .not_before_ns = 0,
                            .run = {.experiment = &planned_}});
    executor_.RunUntil(end_ns);
    recorder_.Finish();
  }

  std::uint64_t dropped() {
    return stack_.tick_records().dropped() + stack_.safety_records().dropped();
  }
  Permit permit() { return stack_.operator_permits().Read().Newest().value; }
  std::int64_t log_errors() const { return recording_.errors(); }

  std::vector<std::string> errors;

 private:
  RigConfig config_ = ShippedRig();
  PlannedExperiment planned_;
  SimulatedStack stack_;
  SpscQueue<TimingRecord> timing_{16};
  EventQueue events_{16};
  RunRecording recording_;
  RecorderTask recorder_;
  HeldUp held_up_;
  LockstepExecutor executor_;
};

TEST(RecorderStall, SixtySecondsLoseNoRecordAndChangeNoTick) {
  RunContents well, stalled;
  RecordedArm without(0, RunInMemory(&well)), with(60 * kStallSecond, RunInMemory(&stalled));
  for (RecordedArm* arm : {&without, &with}) arm->Run(64 * kStallSecond);
  EXPECT_EQ(with.dropped(), 0U);
  EXPECT_TRUE(with.errors.empty());
  EXPECT_EQ(with.permit().state, SafetyState::kRunning);
  ASSERT_EQ(stalled.tick.size(), well.tick.size());
  EXPECT_GT(well.tick.size(), 3000U) << "60 s of ticks";
  for (std::size_t i = 0; i < well.tick.size(); ++i) {
    ASSERT_TRUE(SameBytes(stalled.tick[i].input, well.tick[i].input)) << i;
    ASSERT_TRUE(SameBytes(stalled.tick[i].output, well.tick[i].output)) << i;
  }
  ASSERT_EQ(stalled.safety.size(), well.safety.size());
}

TEST(RecorderStall, WhatALongerOneLosesIsCountedInLogAndJournal) {
  RunContents run;
  RecordedArm arm(300 * kStallSecond, RunInMemory(&run));
  arm.Run(305 * kStallSecond);
  EXPECT_EQ(arm.permit().state, SafetyState::kRunning) << "the loop does not notice";
  ASSERT_GT(arm.dropped(), 0U);
  const std::string count = std::to_string(arm.dropped());
  ASSERT_EQ(arm.errors.size(), 1U);
  EXPECT_EQ(arm.errors[0], "log: " + count + " records were dropped: the recorder was too slow.");
  int told = 0;
  for (const RunEvent& event : run.event) {
    told += event.value_json == "{\"records\":" + count + "}" ? 1 : 0;
  }
  EXPECT_EQ(told, 1);
}

TEST(RecorderStall, AFullDiskEndsTheLogAndNotTheLoop) {
  RunContents run;
  RecordedArm arm(0, [&run](const RunInfo&) { return std::make_unique<FullDisk>(&run, 100); });
  arm.Run(10 * kStallSecond);
  EXPECT_EQ(arm.permit().state, SafetyState::kRunning);
  EXPECT_EQ(run.tick.size(), 100U);
  EXPECT_EQ(arm.log_errors(), 1);
  ASSERT_EQ(arm.errors.size(), 1U);
  EXPECT_NE(arm.errors[0].find("disk is full"), std::string::npos) << arm.errors[0];
  EXPECT_EQ(arm.dropped(), 0U) << "the queues are emptied all the same";
}

}  // namespace
}  // namespace flexarm
