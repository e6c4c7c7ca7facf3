#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "controller/exchange/spsc_queue.h"
#include "controller/realtime/task.h"
#include "controller/reference/timed_reference.h"
#include "controller/safety/windowed_count.h"
#include "controller/step/control_step.h"
#include "controller/tasks/homing_reference.h"
#include "controller/tasks/plan_follower.h"
#include "controller/tasks/planned_experiment.h"
#include "controller/types/frame_packet.h"
#include "controller/types/loop_grid.h"
#include "controller/types/messages.h"
#include "controller/types/records.h"

namespace flexarm {

/// Channels of the control task. All outlive the task.
struct ControlChannels {
  std::vector<FrameChannel*> frames;      ///< read: one a bus, with its part of the readings
  PermitChannel* permits;                 ///< read: state, and the run that was granted
  CalibrationChannel* calibrations;       ///< read
  std::vector<CommandChannel*> commands;  ///< written: one a drive bus
  ControlReportChannel* reports;          ///< written
  SpscQueue<TickRecord>* records;         ///< written: every step, for the log
  SpscQueue<TickRecord>* operator_ticks;  ///< written: every step, for status and commissioning
  PlanFollower* planner = nullptr;        ///< with the law `receding-horizon` only
};

/// The control task: newest frame -> Step -> asked torque, 50 Hz. Never waits.
///
/// - Step k is due `acquire_before` after the sampling instant k Ts. It reads the frame and the
/// permit
///   published before its due instant.
/// - The step is reset after arming, when a run begins, so that each run can be replayed on its own
///   and depends on no run before, and after a new calibration, which is applied only while no
///   torque is allowed.
/// - The torque is put out at the output instant of the grid. The actuation delay of torque k is
///   predicted as the one measured for k-1, plus the delay that the estimator found; the reference
///   is sampled at that instant.
/// - If the step reports a fault, the torque is zero from its deadline on.
/// Real-time: safe after construction.
class ControlTask final : public Task {
 public:
  static constexpr int kPriority = 80;

  /// @param window_periods  SafetyConfig::window_periods, for the count of missed deadlines
  ControlTask(const LoopConfig& loop, int window_periods, ControlStep* step,
              ControlChannels channels);

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  /// Any thread. Experiments with a lower number than this are no longer used.
  std::uint32_t released() const noexcept { return released_.load(std::memory_order_acquire); }

 private:
  void CountDeadlines(const Activation& activation) noexcept;
  FramePacket ReadFrames(std::int64_t sampled_ns) noexcept;
  void FollowState(const Permit& permit) noexcept;
  void StartRun(const Permit& permit) noexcept;
  void FollowRun(const Permit& permit) noexcept;
  void TakeChange(const RunChange& change) noexcept;
  void TakeCalibration() noexcept;
  void Follow(SafetyState state, StepInput* input) noexcept;
  void FollowPlan(StepInput* input) noexcept;
  bool PlansAhead(const StepInput& input) const noexcept;
  StepInput Gather(const Activation& activation, const FramePacket& packet,
                   SafetyState state) noexcept;
  void Publish(const Activation& activation, const StepInput& input,
               const StepOutput& output) noexcept;

  LoopGrid grid_;
  ControlStep* step_;
  ControlChannels channels_;
  const PlannedExperiment* experiment_ = nullptr;  // of the present run, or of the last
  std::uint32_t run_number_ = 0;                   // its number; 0: none yet
  std::uint32_t change_number_ = 0;                // of the change that it follows; 0: none
  std::uint32_t change_seen_ = 0;                  // of the last one permitted
  std::atomic<std::uint32_t> released_{0};
  TimedReference reference_;  // of the experiment
  HomingReference homing_;
  Calibration calibration_{};
  SafetyState state_ = SafetyState::kStarting;
  bool reduced_ = false;                          // by the permit
  LineLevels levels_ = kHealthyLevels;            // as last read by the safety task
  int sample_ = -1;                               // of the experiment, at the measured delay
  int delay_found_ = 0;                           // additional samples, by the last step
  bool reset_ = true;                             // the next step is a reset
  std::array<std::int64_t, kCounters> counts_{};  // of the last step
  std::array<double, 2> hub_angle_rad_{};         // of the last step
  PayloadKnowledge known_ = kNoPayloadEstimate;   // by the last step
  WindowedCount missed_;                          // deadlines
  std::int64_t due_before_ns_ = INT64_MIN;        // of the last activation
  CommandHistory commands_{kNoCommand};
  ControlReportHistory reports_{kNoControlReport};
};

}  // namespace flexarm
