#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "controller/realtime/lockstep_executor.h"
#include "controller/tasks/loop_stack.h"
#include "controller/tasks/planned_experiment.h"
#include "controller/tasks/plant_task.h"
#include "controller/tasks/simulated_lines.h"
#include "controller/tasks/simulated_stack.h"
#include "tests/support/loop_time.h"

namespace flexarm {

/// What is wrong with a reading.
enum class Wrong : std::uint8_t {
  kInvalid,      ///< not valid: no reply, or one that the driver refuses (NaN, out of range)
  kFrozen,       ///< repeats its last value, as valid
  kLate,         ///< that of a period before, with the instant at which it was taken
  kEverySecond,  ///< not valid in every second frame
};
inline constexpr std::array<Wrong, 4> kAllWrongs = {Wrong::kInvalid, Wrong::kFrozen, Wrong::kLate,
                                                    Wrong::kEverySecond};

constexpr const char* ToString(Wrong wrong) {
  switch (wrong) {
    case Wrong::kInvalid:
      return "invalid";
    case Wrong::kFrozen:
      return "frozen";
    case Wrong::kLate:
      return "late";
    case Wrong::kEverySecond:
      return "every second lost";
  }
  return "";
}

/// The same fault of some sensors.
struct SensorFault {
  std::uint32_t strain = 0;    ///< bit i: strain channel i
  std::uint32_t counters = 0;  ///< bit i: counter i
  Wrong wrong = Wrong::kInvalid;
};

/// Copies frames from the plant to the loop, and spoils readings on the way: between sensors and
/// `Step`. Runs after the plant task in the same millisecond.
class FaultTask final : public Task {
 public:
  FaultTask(FrameChannel* from, FrameChannel* to) : from_(from), to_(to) {}

  /// Frames sampled from `from_ns` on are spoilt.
  void Spoil(const SensorFault& fault, std::int64_t from_ns) {
    fault_ = fault;
    fault_ns_ = from_ns;
  }
  /// Frames as sampled, by tick.
  const std::vector<SensorFrame>& sampled() const { return sampled_; }

  Traits traits() const noexcept override {
    return {.name = "faults",
            .period_ns = PlantTask::kPeriodNs,
            .phase_ns = PlantTask::kPeriodNs,
            .deadline_ns = PlantTask::kPeriodNs,
            .priority = PlantTask::kPriority - 1};
  }

  void Run(const Activation& /*activation*/) noexcept override {
    const FrameHistory::Entry entry = from_->Read().Newest();
    if (entry.from_ns == taken_ns_) return;
    taken_ns_ = entry.from_ns;
    FramePacket packet = entry.value;
    const SensorFrame sampled = packet.frame;
    if (entry.from_ns >= fault_ns_) {
      Apply(fault_.strain, sampled.sampled_at_ns, before_.strain, held_.strain,
            &packet.frame.strain, &packet.frame.strain_offset_ns, &packet.frame.strain_valid);
      Apply(fault_.counters, sampled.sampled_at_ns, before_.counter, held_.counter,
            &packet.frame.counter, &packet.frame.counter_offset_ns, &packet.frame.counter_valid);
      ++spoilt_;
    } else {
      held_ = sampled;
    }
    before_ = sampled;
    sampled_.push_back(sampled);
    frames_.Push(entry.from_ns, packet);
    to_->Publish(frames_);
  }

 private:
  template <typename Values, typename Offsets>
  void Apply(std::uint32_t channels, std::int64_t sampled_ns, const Values& before,
             const Values& held, Values* values, Offsets* offsets, std::uint32_t* valid) noexcept {
    const bool lost = fault_.wrong == Wrong::kInvalid ||
                      (fault_.wrong == Wrong::kEverySecond && spoilt_ % 2 == 0);
    if (lost) *valid &= ~channels;
    if (fault_.wrong != Wrong::kFrozen && fault_.wrong != Wrong::kLate) return;
    for (std::size_t i = 0; i < values->size(); ++i) {
      if ((channels >> i & 1U) == 0) continue;
      (*values)[i] = fault_.wrong == Wrong::kFrozen ? held[i] : before[i];
      if (fault_.wrong == Wrong::kLate) {
        (*offsets)[i] = static_cast<std::int32_t>(before_.sampled_at_ns - sampled_ns);
      }
    }
  }

  FrameChannel* from_;
  FrameChannel* to_;
  SensorFault fault_{};
  std::int64_t fault_ns_ = INT64_MAX;
  std::int64_t taken_ns_ = INT64_MIN;
  int spoilt_ = 0;  // frames so far
  SensorFrame before_{}, held_{};
  std::vector<SensorFrame> sampled_;
  FrameHistory frames_{kNoFrame};
};

/// The channels of FaultyStack, constructed before its tasks.
struct FaultyWires : SimulatedWires {
  FrameChannel sampled{FrameHistory(kNoFrame)};
  FaultTask faults{&sampled, &frames};
};

/// The loop's tasks around the simulated arm, in lock step, with sensor faults.
class FaultyStack final : private FaultyWires, public LoopStack {
 public:
  FaultyStack(const RigConfig& config, const Design& design)
      : LoopStack(config, design,
                  {.lines = &lines,
                   .frames = {&frames},
                   .commands = {&commands},
                   .permits = {&permits},
                   .drives = {&drive_reports}}),
        control_(&LoopStack::control()),
        plant_(config, config.arm.payload_mass_kg, {0.0, 0.0},
               {.commands = &commands,
                .permits = &permits,
                .outputs = &outputs,
                .presses = &presses,
                .frames = &sampled,
                .levels = &levels,
                .reports = &drive_reports,
                .truth = &truth,
                .control = &control_}) {}

  FaultTask& fault_task() { return faults; }
  const std::vector<SensorFrame>& sampled_frames() const { return faults.sampled(); }
  SpscQueue<TruthRecord>* truth_records() noexcept override { return &truth; }
  std::vector<Task*> drive_tasks() override { return {&plant_, &faults}; }
  Task& control() override { return control_; }
  std::uint32_t released_experiments() const noexcept override {
    return std::min(LoopStack::released_experiments(), plant_.released());
  }

 private:
  FreezingTask control_;
  PlantTask plant_;
};

/// A session of FaultyStack: requests, and what became of them by tick.
class FaultyRun {
 public:
  FaultyRun(const RigConfig& config, const Design& design, const PlannedExperiment* planned)
      : planned_(planned), stack_(config, design) {
    for (Task* task : stack_.tasks()) executor_.Add(*task);
  }

  void Until(std::int64_t until_ns) {
    while (now_ns_ < until_ns) {
      now_ns_ = std::min(now_ns_ + kPeriodNs, until_ns);
      executor_.RunUntil(now_ns_);
      TickRecord record{};
      while (stack_.tick_records().Pop(&record)) tick.push_back(record);
      TruthRecord shown{};
      while (stack_.truth_records()->Pop(&shown)) truth.push_back(shown.truth);
      RequestAnswer answer{};
      while (stack_.answers().Pop(&answer)) refused = refused || answer.refusal != Refusal::kNone;
    }
  }

  void Ask(RequestKind kind) {
    stack_.requests().Push({.kind = kind,
                            .number = ++asked_,
                            .not_before_ns = now_ns_,
                            .run = {.experiment = planned_}});
  }

  void Spoil(const SensorFault& fault, std::int64_t from_ns) {
    stack_.fault_task().Spoil(fault, from_ns);
  }

  Permit permit() { return stack_.operator_permits().Read().Newest().value; }
  const std::vector<SensorFrame>& sampled() const { return stack_.sampled_frames(); }
  std::int64_t now_ns() const { return now_ns_; }

  std::vector<TickRecord> tick;
  std::vector<PlantTruth> truth;  // by tick
  bool refused = false;

 private:
  const PlannedExperiment* planned_;
  FaultyStack stack_;
  LockstepExecutor executor_;
  std::int64_t now_ns_ = 0;
  std::uint32_t asked_ = 0;
};

}  // namespace flexarm
