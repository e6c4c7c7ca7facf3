#pragma once

#include <array>
#include <cstdint>

#include "controller/exchange/latest_value.h"
#include "controller/realtime/task.h"
#include "controller/realtime/wakeup.h"
#include "controller/safety/torque_gate.h"
#include "controller/safety/windowed_count.h"
#include "controller/step/actuation_queue.h"
#include "controller/tasks/count_watch.h"
#include "controller/types/frame_packet.h"
#include "controller/types/loop_grid.h"
#include "controller/types/messages.h"
#include "hal/bus_device.h"

namespace flexarm {

struct RigConfig;

using BusCounterChannel = LatestValue<BusCounters>;

/// Channels of a bus task. All outlive the task.
struct BusChannels {
  CommandChannel* commands;     ///< read
  PermitChannel* permits;       ///< read
  FrameChannel* frames;         ///< written: this bus's part of the readings
  DriveReportChannel* reports;  ///< written: for the safety task
  DriveReportChannel* health;   ///< written: the same, for the operator task
  BusCounterChannel* counters;  ///< written: BusDevice::counter_values, for the operator task
  Wakeup* wakeup;               ///< the safety task wakes a bus with drives when the power goes
};

/// The task of one bus of a hardware rig. Each period: torque gate, drive output, sensor readings.
/// It may block in its device for as long as the device declares.
///
/// Due at every sampling instant k Ts, so that the readings are available when the step is due,
/// `acquire_before` later. It puts out the command that acts at k Ts, with the newest permit; the
/// command expires with the permit, which the device looks at before each output. When a state
/// without power begins, the safety task wakes the task, which switches its drives off at once, or
/// when the exchange that is under way has ended. A bus
/// that fails twice in a row is lost; it is reconnected only while the arm is disarmed. A drive in
/// fault loses no bus while the device answers: the exchanges go on, with the drives off, and
/// acknowledge the fault only when the permit says that the operator resets. Failed exchanges, and
/// calls that took longer than the device declares, are also counted in a window, wherever they lie
/// in it; an attempt to reconnect is no failed exchange. Real-time: as far as its device is; it
/// does not allocate.
class BusTask final : public Task {
 public:
  static constexpr int kPriority = 70;
  static constexpr int kFailuresToLose = 2;

  /// @param device  opened; outlives the task
  BusTask(const RigConfig& config, BusDevice* device, BusChannels channels);

  /// Instant 0 of the loop in CLOCK_MONOTONIC, the clock of the devices' time stamps. Before Run.
  void SetEpoch(std::int64_t epoch_ns) noexcept { epoch_ns_ = epoch_ns; }

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;
  Wakeup* wakeup() noexcept override { return device_->drives() != 0 ? channels_.wakeup : nullptr; }
  void Woken(std::int64_t now_ns) noexcept override;

 private:
  BusCommand Command(std::int64_t due_ns) noexcept;
  void CountDuration(const Activation& activation) noexcept;
  /// Exchange or Reconnect, and the count of failures.
  void Work(const BusCommand& command, SensorFrame* part) noexcept;
  DrivePower Power() const noexcept;
  CountEpochs Epochs() const noexcept;
  void Publish(std::int64_t due_ns, const SensorFrame& part) noexcept;

  BusDevice* device_;
  LoopGrid grid_;
  GateLimits limits_;
  BusChannels channels_;
  std::int64_t epoch_ns_ = 0;
  std::array<double, 2> applied_nm_{};  // torque of the last exchange
  std::int64_t applied_tick_ = -1;      // tick of its command
  ActuationQueue applied_;              // with the instant at which each acted
  CountWatch counts_;
  BusStatus status_ = BusStatus::kOk;
  bool answered_ = false;         // the last exchange; also if a drive is in fault
  bool exchanged_ = false;        // it was an exchange, not a reconnection
  bool enabled_ = false;          // the drives, by the last exchange
  std::int64_t next_due_ns_ = 0;  // of the next exchange
  int failures_ = 0;              // in a row
  WindowedCount failed_lately_;
  WindowedCount slow_lately_;
  std::int64_t worst_case_ns_;  // declared by the device
  bool ran_ = false;
  std::uint32_t slow_ = 0;
  std::int64_t longest_ns_ = 0;
  std::uint32_t failed_ = 0;
  std::uint32_t gate_reasons_ = 0,
                gate_before_ = 0;  // GateBits of the newest torque and the one before
  std::uint32_t recovered_ = 0;
  LineLevels levels_ = kHealthyLevels;
  FrameHistory frames_{kNoFrame};
  DriveReportHistory reports_{kNoDriveReport};
};

}  // namespace flexarm
