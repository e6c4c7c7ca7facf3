#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "controller/tasks/freezing_task.h"
#include "controller/tasks/loop_stack.h"
#include "controller/tasks/plant_task.h"
#include "controller/tasks/simulated_stack.h"
#include "tools/torture/fault.h"
#include "tools/torture/faulty_frames.h"
#include "tools/torture/faulty_lines.h"
#include "tools/torture/faulty_torque.h"
#include "tools/torture/session_watch.h"

namespace flexarm {

/// The thread of bus and drives: the simulated arm, with faults of what passes to and from it.
class TorturedPlant final : public Task {
 public:
  struct Channels {
    CommandChannel* asked;        ///< read: from the loop
    CommandChannel* commands;     ///< written: to the arm
    FrameChannel* sampled;        ///< read: from the arm
    FrameChannel* frames;         ///< written: to the loop
    DriveReportChannel* told;     ///< read: from the arm
    DriveReportChannel* reports;  ///< written: to the loop
  };

  TorturedPlant(const RigConfig& config, PlantTask* plant, const Channels& channels,
                const std::vector<Fault>& faults);

  Traits traits() const noexcept override { return plant_->traits(); }
  void Run(const Activation& activation) noexcept override;

  /// From now on every other frame counts one more, as an encoder that rests on the edge of a
  /// count; null: none does.
  void Flicker(const EncoderConfig* encoder) noexcept { flickers_ = encoder; }

  /// FaultyFrames::seen_ns
  std::int64_t seen_ns() const noexcept { return spoiled_frames_.seen_ns(); }
  /// Largest true strain at a gauge in the newest frame, over its limit.
  double strain_share() const noexcept { return strain_share_; }

 private:
  void PassCommands() noexcept;
  void PassFrames() noexcept;
  void PassReports(std::int64_t due_ns) noexcept;

  double StrainShare(const SensorFrame& sampled) const noexcept;

  const RigConfig& config_;
  PlantTask* plant_;
  Channels channels_;
  const std::vector<Fault>* faults_;
  FaultyFrames spoiled_frames_;
  FaultyTorque spoiled_torque_;
  std::int64_t period_ns_;
  std::int64_t command_ns_ = INT64_MIN, frame_ns_ = INT64_MIN;  // of the last one passed
  const EncoderConfig* flickers_ = nullptr;
  int reported_ = 0;
  double strain_share_ = 0.0;
  CommandHistory commands_{kNoCommand};
  FrameHistory frames_{kNoFrame};
  DriveReportHistory reports_{kNoDriveReport};
};

/// The channels of TorturedStack, constructed before its tasks.
struct TorturedWires : SimulatedWires {
  explicit TorturedWires(const std::vector<Fault>& faults) : faulty_lines(&lines, faults) {}

  CommandChannel asked{CommandHistory(kNoCommand)};
  FrameChannel sampled{FrameHistory(kNoFrame)};
  DriveReportChannel told{DriveReportHistory(kNoDriveReport)};
  FaultyLines faulty_lines;
};

/// The daemon's real-time tasks around the simulated arm with faults between all of them. Late
/// threads trip, as on a rig whose metal moves.
class TorturedStack final : private TorturedWires, public LoopStack {
 public:
  /// @param plant   config of the simulated rig
  /// @param faults  outlive the stack
  TorturedStack(const RigConfig& config, const RigConfig& plant, const Design& design,
                double payload_kg, const std::vector<Fault>& faults);

  std::vector<Task*> drive_tasks() override { return {&side_}; }
  Task& control() override { return control_; }
  bool simulated() const noexcept override { return true; }
  bool Press(const LinePress& press) noexcept override { return presses.Push(press); }
  SpscQueue<TruthRecord>* truth_records() noexcept override { return &truth; }
  std::uint32_t released_experiments() const noexcept override;

  const PlantTask& arm() const noexcept { return plant_; }
  /// Before any task runs: PlantTask::BeginAt.
  void BeginAt(std::int64_t start_ns) noexcept { plant_.BeginAt(start_ns); }
  /// TorturedPlant::Flicker
  void Flicker(const EncoderConfig* encoder) noexcept { side_.Flicker(encoder); }
  SafetyStatus status() noexcept { return safety().status(); }
  WatchSample Sample() noexcept;
  std::int64_t seen_ns() const noexcept { return side_.seen_ns(); }

 private:
  FreezingTask control_;
  PlantTask plant_;
  TorturedPlant side_;
};

}  // namespace flexarm
