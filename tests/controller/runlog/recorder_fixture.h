#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/runlog/recorder_task.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {

inline constexpr std::int64_t kSecond = 1'000'000'000;
inline constexpr SafetyStatus kArmedStatus{SafetyState::kArmed, TripCause::kNone};
inline constexpr SafetyStatus kRunningStatus{SafetyState::kRunning, TripCause::kNone};

inline OpenSink InFolder(const std::filesystem::path& folder) {
  return [folder](const RunInfo& info) {
    return RunInFile(NewRunFile(folder, info.experiment_name))(info);
  };
}

class RecorderTest : public RunLogTest {
 protected:
  explicit RecorderTest(std::size_t capacity = 4096)
      : ticks_(capacity), safety_(capacity), timing_(capacity), events_(capacity) {}

  void Start(OpenSink open) {
    recording_.emplace(MakeInfo(), std::move(open), [this](bool is_error, const std::string& text) {
      (is_error ? errors_ : notes_).push_back(text);
    });
    recorder_.emplace(RecorderChannels{&ticks_, &safety_, &timing_, &events_, &truth_},
                      &*recording_);
  }
  void Arm(std::int64_t at_ns) { safety_.Push(MakeSafety(at_ns, kIdleStatus, RequestKind::kArm)); }
  // Grants a run at `at_ns`; the first tick after it carries the reset.
  void Grant(std::int64_t at_ns, std::uint32_t number = 1) {
    SafetyRecord record = MakeSafety(at_ns, kArmedStatus, RequestKind::kRun);
    record.request_number = number;
    safety_.Push(record);
  }
  // From `before`: a change without a request, by these facts.
  SafetyRecord Change(std::int64_t at_ns, SafetyStatus before,
                      const std::function<void(SafetyFacts*)>& set) {
    SafetyRecord record = MakeSafety(at_ns, before, RequestKind::kNone);
    set(&record.facts);
    const SafetyDecision next = NextSafetyState(before, record.facts);
    record.after = next.status;
    safety_.Push(record);
    return record;
  }
  void Ticks(std::int64_t first, std::int64_t last, std::int64_t reset) {
    for (std::int64_t tick = first; tick <= last; ++tick) {
      TickRecord record = MakeTick(tick);
      record.input.reset = tick == reset ? 1 : 0;
      ticks_.Push(record);
    }
  }
  void RunUntil(std::int64_t end_ns) {
    for (; due_ns_ <= end_ns; due_ns_ += RecorderTask::kPeriodNs) {
      recorder_->Run({.due_ns = due_ns_, .missed_in_a_row = 0});
    }
  }

  SpscQueue<TickRecord> ticks_;
  SpscQueue<SafetyRecord> safety_;
  SpscQueue<TimingRecord> timing_;
  EventQueue events_;
  SpscQueue<TruthRecord> truth_{4096};
  std::optional<RunRecording> recording_;
  std::optional<RecorderTask> recorder_;
  std::vector<std::string> errors_, notes_;
  std::int64_t due_ns_ = 0;
};

}  // namespace flexarm
