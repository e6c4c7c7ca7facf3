#include "controller/tasks/bus_task.h"

#include <algorithm>
#include <utility>

#include "controller/types/rig_config.h"

namespace flexarm {
namespace {

// Frames that are sent so shortly before an exchange would still wait when it begins.
constexpr std::int64_t kSoonNs = 500'000;

}  // namespace

BusTask::BusTask(const RigConfig& config, BusDevice* device, BusChannels channels)
    : device_(device),
      grid_(config.loop),
      limits_(MakeGateLimits(config.safety, grid_)),
      channels_(channels),
      counts_(config.sensors),
      failed_lately_(config.safety.window_periods),
      slow_lately_(config.safety.window_periods),
      worst_case_ns_(device->worst_case_ns()) {}

Task::Traits BusTask::traits() const noexcept {
  return {.name = device_->name(),
          .period_ns = grid_.period_ns,
          .phase_ns = 0,
          .deadline_ns = grid_.phase_ns,
          .priority = kPriority};
}

// The activation before was one call of the device, and the time around it is small.
void BusTask::CountDuration(const Activation& activation) noexcept {
  if (!std::exchange(ran_, true)) return;
  const bool slow = activation.previous_run_ns > worst_case_ns_;
  slow_lately_.Push(slow);
  slow_ += slow ? 1 : 0;
  longest_ns_ = std::max(longest_ns_, activation.previous_run_ns);
}

void BusTask::Run(const Activation& activation) noexcept {
  CountDuration(activation);
  next_due_ns_ = activation.due_ns + grid_.period_ns;
  const BusCommand command = Command(activation.due_ns);
  SensorFrame part{};
  Work(command, &part);
  Publish(activation.due_ns, part);
}

void BusTask::Work(const BusCommand& command, SensorFrame* part) noexcept {
  const bool in_fault = answered_ && status_ == BusStatus::kDriveFault;
  exchanged_ = failures_ == 0 || command.enabled || !device_->needs_reconnect();
  status_ = exchanged_ ? device_->Exchange(command, part) : device_->Reconnect();
  const bool read = exchanged_ && part->sampled_at_ns != 0;
  const bool in_fault_only =
      status_ == BusStatus::kDriveFault && read && !device_->needs_reconnect();
  answered_ = status_ == BusStatus::kOk || in_fault_only;
  if (exchanged_) failed_lately_.Push(!answered_);
  if (answered_) {
    if (failures_ >= kFailuresToLose) ++recovered_;
    failures_ = 0;
  } else {
    failures_ = std::min(failures_ + 1, kFailuresToLose);
  }
  // A fault that stays until the operator resets is counted once.
  if (status_ != BusStatus::kOk && !(answered_ && in_fault)) ++failed_;
  if (!exchanged_) counts_.Reconnected();
  if (answered_ && exchanged_) counts_.Take(*part);
}

void BusTask::Woken(std::int64_t now_ns) noexcept {
  const Permit& permit = channels_.permits->Read().Newest().value;
  if (!enabled_ || DrivesEnabled(permit.state)) return;
  if (now_ns + kSoonNs >= next_due_ns_) return;  // the exchange switches them off
  enabled_ = false;
  gate_reasons_ |= kGateNotAllowed;
  // If it fails, the next exchange tries again, and reports it.
  if (device_->SwitchOff() != BusStatus::kOk) return;
  applied_nm_ = {};
  applied_.Push(now_ns + grid_.actuation_ns, applied_nm_);
}

// Applies the torque gate to the command that acts now. A failed exchange is not repeated: the next
// one sends the newest command, as on a healthy bus.
BusCommand BusTask::Command(std::int64_t due_ns) noexcept {
  const CommandHistory::Entry& command = channels_.commands->Read().At(due_ns);
  const Permit& permit = channels_.permits->Read().Newest().value;
  applied_tick_ = command.value.tick;
  const GateResult gated =
      Gate({.asked_nm = command.value.torque_nm,
            .asked_age_ns = AgeNs(due_ns, command.from_ns),
            .permit = permit.state,
            .homing = Homes(permit.run),
            .reduced = permit.reduced,
            .permit_age_ns = std::max<std::int64_t>(AgeNs(due_ns, permit.renewed_ns), 0),
            .previous_nm = applied_nm_,
            .dt_s = grid_.period_s()},
           limits_);
  gate_reasons_ = device_->drives() != 0 ? gated.why : 0;
  for (std::size_t i = 0; i < 2; ++i) {
    // A drive that is still being enabled makes no torque, and the estimator is told none.
    applied_nm_[i] = (device_->drives_on() >> i & 1u) != 0 ? gated.torque_nm[i] : 0.0;
  }
  enabled_ = DrivesEnabled(permit.state) && (gated.why & kGatePermitOld) == 0;
  BusCommand out{.torque_nm = applied_nm_, .enabled = enabled_};
  if ((gated.why & kGateZeroed) == 0) {
    out.expires_ns = epoch_ns_ + std::min(permit.renewed_ns + limits_.permit_timeout_ns,
                                          command.from_ns + limits_.command_timeout_ns);
  }
  out.acknowledge = permit.acknowledge && !enabled_ && (gated.why & kGatePermitOld) == 0;
  return out;
}

DrivePower BusTask::Power() const noexcept {
  const std::uint32_t drives = device_->drives();
  if (drives == 0) return DrivePower::kNone;
  if (status_ != BusStatus::kOk) return DrivePower::kMixed;  // nothing was confirmed
  const std::uint32_t on = device_->drives_on() & drives;
  return on == 0 ? DrivePower::kOff : on == drives ? DrivePower::kOn : DrivePower::kMixed;
}

CountEpochs BusTask::Epochs() const noexcept {
  CountEpochs epochs = device_->count_epochs();
  for (std::size_t i = 0; i < epochs.size(); ++i) epochs[i] += counts_.epochs()[i];
  return epochs;
}

void BusTask::Publish(std::int64_t due_ns, const SensorFrame& part) noexcept {
  FramePacket packet{};
  packet.frame.sampled_at_ns = due_ns;  // after a failed exchange no reading is valid
  if (answered_ && exchanged_) {
    packet.frame = part;
    packet.frame.sampled_at_ns -= epoch_ns_;
    levels_ = (part.levels & device_->lines()) | (kHealthyLevels & ~device_->lines());
  }
  packet.gate_reasons = gate_before_;
  gate_before_ = gate_reasons_;
  packet.applied_torque_nm =
      applied_.Between(due_ns - grid_.period_ns, due_ns, grid_.period_ns).mean_nm();
  // On a bus with drives the frame's instant is also the instant of the torque output: the SYNC of
  // CANopen, or the end of the analogue outputs of a board.
  const bool stamped = status_ == BusStatus::kOk && device_->drives() != 0;
  packet.acted_ns = (stamped ? packet.frame.sampled_at_ns : due_ns) + grid_.actuation_ns;
  if (stamped) packet.output_tick = applied_tick_;
  applied_.Push(packet.acted_ns, applied_nm_);
  frames_.Push(due_ns, packet);
  channels_.frames->Publish(frames_);
  reports_.Push(due_ns,
                {.due_ns = due_ns,
                 .bus_ok = failures_ < kFailuresToLose,
                 .drive_ok = status_ != BusStatus::kDriveFault,
                 .fault = status_ == BusStatus::kOk ? BusFault{} : device_->FaultOf(status_),
                 .failed = failed_,
                 .recovered = recovered_,
                 .levels = levels_,
                 .power = Power(),
                 .failed_in_window = failed_lately_.count(),
                 .slow_in_window = slow_lately_.count(),
                 .slow = slow_,
                 .longest_ns = longest_ns_,
                 .notice = device_->notice(),
                 .count_epochs = Epochs(),
                 .voltage = answered_ && exchanged_ ? device_->voltage() : DriveVoltage{}});
  channels_.reports->Publish(reports_);
  channels_.health->Publish(reports_);
  channels_.counters->Publish(device_->counter_values());
}

}  // namespace flexarm
