#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "controller/exchange/spsc_queue.h"
#include "controller/realtime/task.h"
#include "controller/safety/torque_gate.h"
#include "controller/tasks/freezing_task.h"
#include "controller/tasks/loop_stack.h"
#include "controller/tasks/planned_experiment.h"
#include "controller/tasks/simulated_lines.h"
#include "controller/types/frame_packet.h"
#include "controller/types/loop_grid.h"
#include "controller/types/messages.h"
#include "controller/types/records.h"
#include "hal/sim/frame_loss.h"
#include "hal/sim/simulated_rig.h"

namespace flexarm {

struct RigConfig;

/// Channels of the plant task. All outlive the task.
struct PlantChannels {
  CommandChannel* commands;       ///< read
  PermitChannel* permits;         ///< read; the sim_events are those of its run
  OutputChannel* outputs;         ///< read: relay and charge pump
  SpscQueue<LinePress>* presses;  ///< read
  FrameChannel* frames;           ///< written
  LevelChannel* levels;           ///< written
  DriveReportChannel* reports;    ///< written
  SpscQueue<TruthRecord>* truth;  ///< written: true state of the arm, for the log
  FreezingTask* control;          ///< frozen if the experiment has such an event
};

/// The task of the simulated backend: 1 kHz, integrates the plant up to its due instant.
///
/// - Each slice of 1 ms, from s to s + 1 ms, has the torque valid at s: the command that acts,
/// after
///   the gate with the permit of s; zero if the relay is open or the charge pump has not toggled
///   for 5 ms. The slice is integrated at its end, so every task has 1 ms to publish what is valid
///   at s.
/// - Frames are sampled at exactly k Ts. A lost frame holds no reading, as after a failed exchange
/// of
///   a bus; the drive continues.
/// - Reported torques are those that a bus can report: after the same gate, with the declared delay
///   (`loop.actuation_delay_ms`), independent of `sim.transport_delay_ms`.
/// - After a late activation it catches up: simulated time is not lost.
/// Real-time: safe after construction.
class PlantTask final : public Task {
 public:
  static constexpr std::int64_t kPeriodNs = 1'000'000;
  static constexpr int kPriority = 60;

  /// @param payload_kg  payload of the plant, instead of that of the config's arm
  /// @param start_rad   hub angles at the start, SimulatedRig
  PlantTask(const RigConfig& config, double payload_kg, const std::array<double, 2>& start_rad,
            PlantChannels channels);

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  /// The clock is at `start_ns` when the arm is switched on: a whole period. Before any task runs.
  void BeginAt(std::int64_t start_ns) noexcept;

  /// Any thread. Experiments with a lower number than this are no longer used.
  std::uint32_t released() const noexcept { return released_.load(std::memory_order_acquire); }

  // In lock step, between two activations.
  const SimulatedRig& rig() const noexcept { return rig_; }
  /// The arm has been integrated up to here.
  std::int64_t integrated_ns() const noexcept { return now_ns_; }
  /// What acts on the arm since the last slice, N m.
  const std::array<double, 2>& drive_torque_nm() const noexcept { return drive_.torque_nm; }

 private:
  // A drive with a delay of its commands.
  struct Drive {
    std::int64_t delay_ns;
    std::array<double, 2> torque_nm{};
    std::int64_t command_acts_ns = INT64_MIN;  // of the last command of the gate
  };

  void AdvanceSlice(std::int64_t start_ns) noexcept;
  /// @returns GateBits
  std::uint32_t ApplyGate(std::int64_t start_ns, const Permit& permit,
                          const CommandHistory& commands, Drive* drive) noexcept;
  /// The drives are enabled, and have power: relay and charge pump.
  bool Enabled(std::int64_t start_ns, const Permit& permit) noexcept;
  void HandleEvents(std::int64_t now_ns) noexcept;
  void FreezeControlTask() noexcept;
  void StartFrame(std::int64_t now_ns) noexcept;
  void PublishFrame() noexcept;

  SimulatedRig rig_;
  FrameLoss loss_;
  LoopGrid grid_;
  GateLimits limits_;
  Drive drive_;                                    // acts on the plant
  Drive reported_;                                 // the same with the declared delay, for reports
  const PlannedExperiment* experiment_ = nullptr;  // of the run that began at run_since_ns_
  std::int64_t run_since_ns_ = INT64_MIN;
  std::uint32_t change_number_ = 0;  // of the change of the present run; 0: none
  std::size_t next_event_ = 0;
  std::atomic<std::uint32_t> released_{0};
  PlantChannels channels_;

  std::int64_t now_ns_ = 0;  // the plant has been integrated up to here
  bool frozen_ = false;
  std::array<double, 2> applied_sum_nm_{};  // as reported
  int applied_slices_ = 0;
  std::uint32_t gate_reasons_ = 0;  // GateBits since the last frame
  FramePacket packet_{};            // of the last sampling instant, until its readings are complete
  std::int64_t packet_ns_ = 0;
  bool packet_lost_ = false;
  bool enabled_ = false;  // the drives, in the last slice
  bool pump_level_ = false;
  std::int64_t pump_toggled_ns_ = INT64_MIN;
  FrameHistory frames_{kNoFrame};
  LevelHistory levels_{kHealthyLevels};
  DriveReportHistory reports_{kNoDriveReport};
};

}  // namespace flexarm
