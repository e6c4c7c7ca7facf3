#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "controller/exchange/spsc_queue.h"
#include "controller/realtime/task.h"
#include "controller/step/control_step.h"
#include "controller/tasks/homing_reference.h"
#include "controller/tasks/loaded_experiment.h"
#include "controller/tasks/plan_follower.h"
#include "controller/types/frame_packet.h"
#include "controller/types/loop_grid.h"
#include "controller/types/messages.h"
#include "controller/types/records.h"

namespace flexarm {

/// Everything that the control task touches. All of it outlives the task.
struct ControlChannels {
  std::vector<FrameChannel*> frames;      ///< read: each holds its own part of the readings
  PermitChannel* permits;                 ///< read
  ExperimentChannel* plans;               ///< read
  CalibrationChannel* calibrations;       ///< read
  std::vector<CommandChannel*> commands;  ///< written: one a drive bus
  ControlReportChannel* reports;          ///< written
  SpscQueue<TickRecord>* records;         ///< written: every step, for the log
  SpscQueue<TickRecord>* operator_ticks;  ///< written: every step, for status and commissioning
  PlanFollower* planner = nullptr;        ///< of the law `receding-horizon`
};

/// The control thread's body: newest frame -> Step -> asked torque, 50 Hz. Never waits.
///
/// Step k is due `acquire_before` after the sampling instant k Ts, and takes the frame and the
/// permit that held before it was due. It is reset when it finds the arm newly armed, or newly
/// calibrated; a calibration is taken over while no torque is allowed. Its torque
/// is put out when the grid says; it is expected to act as late as the last one did, as far as the
/// drive side knows; where a step found more delay, or less, the reference is that of the instant
/// found. A fault that it sees takes the torque away at its deadline. Real-time: safe
/// after construction.
class ControlTask final : public Task {
 public:
  static constexpr int kPriority = 80;

  ControlTask(const LoopConfig& loop, ControlStep* step, ControlChannels channels);

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  /// Any thread. Plans with a lower number than this are no longer used.
  std::uint32_t released() const noexcept { return released_.load(std::memory_order_acquire); }

 private:
  FramePacket ReadFrames(std::int64_t sampled_ns) noexcept;
  void FollowState(const Permit& permit) noexcept;
  void StartRun() noexcept;
  void TakeCalibration() noexcept;
  void FollowReference(SafetyState state, StepInput* input) noexcept;
  void FollowPlan(StepInput* input) noexcept;
  bool PlansAhead(const StepInput& input) const noexcept;
  ReferenceSample ReferenceAtSample(const ReferenceTable& reference) const noexcept;
  StepInput Gather(const Activation& activation, const FramePacket& packet,
                   SafetyState state) noexcept;
  void Publish(const Activation& activation, const StepInput& input,
               const StepOutput& output) noexcept;

  LoopGrid grid_;
  ControlStep* step_;
  ControlChannels channels_;
  LoadedExperiment plan_;
  std::atomic<std::uint32_t> released_{0};
  HomingReference homing_;
  Calibration calibration_{};
  SafetyState state_ = SafetyState::kStarting;
  LineLevels levels_ = kHealthyLevels;  // as the safety task read them last
  int sample_ = -1;                     // of the experiment, when the torque acts as known
  int delay_found_ = 0;                 // samples that the last step found beyond that
  bool reset_ = true;                   // the next step starts afresh
  std::array<std::int64_t, kCounters> counts_{};  // of the last step
  std::array<double, 2> hub_angle_rad_{};         // of the last step
  CommandHistory commands_{kNoCommand};
  ControlReportHistory reports_{kNoControlReport};
};

}  // namespace flexarm
