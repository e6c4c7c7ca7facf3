#pragma once

#include <cstdint>
#include <vector>

#include "controller/tasks/loop_stack.h"
#include "controller/tasks/plant_task.h"
#include "controller/tasks/simulated_lines.h"

namespace flexarm {

/// The channels between the loop and the plant task. A base of SimulatedStack, so that they are
/// constructed before the tasks that use them.
struct SimulatedWires {
  FrameChannel frames{FrameHistory(kNoFrame)};
  CommandChannel commands{CommandHistory(kNoCommand)};
  PermitChannel permits{PermitHistory(kNoPermit)};
  OutputChannel outputs{OutputHistory({.relay_closed = false, .pump_level = false})};
  LevelChannel levels{LevelHistory(kHealthyLevels)};
  DriveReportChannel drive_reports{DriveReportHistory(kNoDriveReport)};
  SpscQueue<LinePress> presses{64};
  SpscQueue<TruthRecord> truth{4000};  // as the queue of steps
  SimulatedLines lines{&levels, &outputs};
};

/// The daemon's real-time tasks with the simulated rig in process, for either executor. No metal
/// moves: late threads are counted and do not trip.
class SimulatedStack final : private SimulatedWires, public LoopStack {
 public:
  /// @param payload_kg  of the plant; the design has that of the config
  SimulatedStack(const RigConfig& config, const Design& design, double payload_kg)
      : SimulatedStack(config, config, design, payload_kg) {}
  /// @param plant      config of the simulated rig, if it differs from that of the design
  /// @param start_rad  hub angles at the start, SimulatedRig
  SimulatedStack(const RigConfig& config, const RigConfig& plant, const Design& design,
                 double payload_kg, const std::array<double, 2>& start_rad = {});

  PlantTask& plant() { return plant_; }
  std::vector<Task*> drive_tasks() override { return {&plant_}; }
  Task& control() override { return control_; }

  std::uint32_t released_experiments() const noexcept override;
  bool simulated() const noexcept override { return true; }
  bool Press(const LinePress& press) noexcept override { return presses.Push(press); }
  SpscQueue<TruthRecord>* truth_records() noexcept override { return &truth; }

 private:
  FreezingTask control_;
  PlantTask plant_;
};

}  // namespace flexarm
