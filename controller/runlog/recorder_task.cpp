#include "controller/runlog/recorder_task.h"

#include <algorithm>
#include <exception>

namespace flexarm {
namespace {

constexpr std::int64_t kHoldBackNs = 100'000'000;
constexpr std::int64_t kCommitEveryNs = 250'000'000;

std::int64_t TimeOf(const TickRecord& record) { return record.input.now_ns; }
std::int64_t TimeOf(const SafetyRecord& record) { return record.due_ns; }
std::int64_t TimeOf(const TimingRecord& record) { return record.due_ns; }
std::int64_t TimeOf(const RunEvent& event) { return event.time_ns; }

template <typename Queue, typename T>
void DrainInto(Queue* queue, std::deque<T>* pending) {
  T value;
  while (queue->Pop(&value)) pending->push_back(value);
}

template <typename T>
std::int64_t Head(const std::deque<T>& pending) {
  return pending.empty() ? INT64_MAX : TimeOf(pending.front());
}

}  // namespace

RecorderTask::RecorderTask(RecorderChannels channels, RunRecording* recording, RunFiles* files)
    : channels_(channels), recording_(recording), files_(files) {}

Task::Traits RecorderTask::traits() const noexcept {
  return {.name = "recorder",
          .period_ns = kPeriodNs,
          .phase_ns = 0,
          .deadline_ns = kPeriodNs,
          .priority = 0};
}

void RecorderTask::Drain() {
  DrainInto(channels_.safety, &safety_);
  DrainInto(channels_.events, &events_);
  DrainInto(channels_.ticks, &ticks_);
  DrainInto(channels_.timing, &timing_);
  // After the ticks: a step runs after its truth was written.
  if (channels_.truth != nullptr) DrainInto(channels_.truth, &truth_);
}

void RecorderTask::AddTruth(TickRecord* record) {
  while (!truth_.empty() && truth_.front().tick < record->input.tick) truth_.pop_front();
  if (!truth_.empty() && truth_.front().tick == record->input.tick) {
    record->truth = truth_.front().truth;
  }
}

// At one instant: events first (they announce an experiment), then safety, tick, timing.
void RecorderTask::Merge(std::int64_t horizon_ns) {
  const auto take = [](auto* pending, auto hand_over) {
    hand_over(pending->front());
    pending->pop_front();
  };
  while (true) {
    const std::int64_t event = Head(events_), safety = Head(safety_), tick = Head(ticks_),
                       timing = Head(timing_);
    const std::int64_t next = std::min({event, safety, tick, timing});
    if (next == INT64_MAX || next > horizon_ns) break;
    recording_->Until(next);
    if (next == event) {
      take(&events_, [&](const RunEvent& value) { recording_->Event(value); });
    } else if (next == safety) {
      take(&safety_, [&](const SafetyRecord& value) { recording_->Safety(value); });
    } else if (next == tick) {
      take(&ticks_, [&](TickRecord& value) {
        AddTruth(&value);
        recording_->Tick(value);
      });
    } else {
      take(&timing_, [&](const TimingRecord& value) { recording_->Timing(value); });
    }
  }
  recording_->Until(horizon_ns);
}

// Queued like any other event: the run that it belongs to may not be open yet, or none is open at
// all, so it is in the journal too.
void RecorderTask::NoteDropped(std::int64_t now_ns) {
  const std::uint64_t dropped = channels_.ticks->dropped() + channels_.safety->dropped() +
                                channels_.timing->dropped() + channels_.events->dropped();
  if (dropped == dropped_) return;
  const std::string count = std::to_string(dropped - dropped_);
  const std::string text = count + " records were dropped: the recorder was too slow.";
  dropped_ = dropped;
  recording_->ReportGap(text);
  events_.push_back({.time_ns = now_ns,
                     .kind = "gap",
                     .name = "dropped",
                     .text = text,
                     .value_json = "{\"records\":" + count + "}"});
}

void RecorderTask::Run(const Activation& activation) noexcept {
  try {
    Drain();
    NoteDropped(activation.due_ns);
    Merge(activation.due_ns - kHoldBackNs);
    if (files_ != nullptr) files_->Follow(activation.due_ns);
    if (committed_ns_ != INT64_MIN && activation.due_ns - committed_ns_ < kCommitEveryNs) return;
    committed_ns_ = activation.due_ns;
    recording_->Commit();
  } catch (const std::exception&) {
    recording_->CountError("the recorder is out of memory");
  }
}

void RecorderTask::Finish() noexcept {
  try {
    Drain();
    Merge(INT64_MAX);
  } catch (const std::exception&) {
    recording_->CountError("the recorder is out of memory");
  }
  recording_->Finish();
}

}  // namespace flexarm
