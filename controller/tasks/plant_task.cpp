#include "controller/tasks/plant_task.h"

#include <cmath>
#include <csignal>
#include <optional>

#include "controller/types/rig_config.h"

namespace flexarm {
namespace {

ArmParameters WithPayload(ArmParameters arm, double payload_kg) {
  arm.payload_mass_kg = payload_kg;
  return arm;
}

}  // namespace

PlantTask::PlantTask(const RigConfig& config, double payload_kg,
                     const std::array<double, 2>& start_rad, PlantChannels channels)
    : rig_(WithPayload(config.arm, payload_kg), config.sensors, config.sim, start_rad),
      loss_(config.sim.lost_frame_fraction, config.sim.seed),
      grid_(config.loop),
      limits_(MakeGateLimits(config.safety, grid_)),
      drive_{.delay_ns = std::llround(config.sim.transport_delay_ms * 1e6)},
      reported_{.delay_ns = grid_.actuation_ns},
      channels_(channels) {
  BeginAt(0);
}

void PlantTask::BeginAt(std::int64_t start_ns) noexcept {
  now_ns_ = start_ns;
  StartFrame(start_ns);
  PublishFrame();
}

Task::Traits PlantTask::traits() const noexcept {
  return {.name = "plant",
          .period_ns = kPeriodNs,
          .phase_ns = kPeriodNs,
          .deadline_ns = kPeriodNs,
          .priority = kPriority};
}

void PlantTask::Run(const Activation& activation) noexcept {
  while (!frozen_ && now_ns_ < activation.due_ns) {
    AdvanceSlice(now_ns_);
    now_ns_ += kPeriodNs;
    HandleEvents(now_ns_);
    levels_.Push(now_ns_, rig_.levels());
    channels_.levels->PublishGrown(levels_);
    if (now_ns_ % grid_.period_ns == 0) StartFrame(now_ns_);
    PublishFrame();
  }
  if (frozen_) return;
  reports_.Push(activation.due_ns + kPeriodNs,
                {.due_ns = activation.due_ns,
                 .bus_ok = true,
                 .drive_ok = true,
                 .power = enabled_ ? DrivePower::kOn : DrivePower::kOff});
  channels_.reports->PublishGrown(reports_);
}

void PlantTask::AdvanceSlice(std::int64_t start_ns) noexcept {
  const Permit& permit = channels_.permits->Read().At(start_ns).value;
  const CommandHistory& commands = channels_.commands->Read();
  enabled_ = Enabled(start_ns, permit);
  gate_reasons_ |= ApplyGate(start_ns, permit, commands, &drive_);
  ApplyGate(start_ns, permit, commands, &reported_);
  rig_.SetTorque(drive_.torque_nm);
  for (std::int64_t t = 0; t < kPeriodNs; t += rig_.step_ns()) rig_.Step();
  for (std::size_t i = 0; i < 2; ++i) applied_sum_nm_[i] += reported_.torque_nm[i];
  ++applied_slices_;
}

// The slew limit applies from command to command: between two commands the drive holds its
// set-point.
std::uint32_t PlantTask::ApplyGate(std::int64_t start_ns, const Permit& permit,
                                   const CommandHistory& commands, Drive* drive) noexcept {
  const std::int64_t acting_ns = start_ns - drive->delay_ns;
  const CommandHistory::Entry& command = commands.At(acting_ns);
  const bool fresh = command.from_ns != drive->command_acts_ns;
  drive->command_acts_ns = command.from_ns;
  const GateResult gated = Gate({.asked_nm = command.value.torque_nm,
                                 .asked_age_ns = AgeNs(acting_ns, command.from_ns),
                                 .permit = permit.state,
                                 .homing = Homes(permit.run),
                                 .reduced = permit.reduced,
                                 .permit_age_ns = AgeNs(start_ns, permit.renewed_ns),
                                 .previous_nm = drive->torque_nm,
                                 .dt_s = fresh ? grid_.period_s() : 0.0},
                                limits_);
  drive->torque_nm = enabled_ ? gated.torque_nm : std::array<double, 2>{};
  return gated.why;
}

bool PlantTask::Enabled(std::int64_t start_ns, const Permit& permit) noexcept {
  const SafetyLines::Outputs& outputs = channels_.outputs->Read().At(start_ns).value;
  if (outputs.pump_level != pump_level_) {
    pump_level_ = outputs.pump_level;
    pump_toggled_ns_ = start_ns;
  }
  return DrivesEnabled(permit.state) && outputs.relay_closed &&
         AgeNs(start_ns, pump_toggled_ns_) <= SafetyLines::kPumpTimeoutNs;
}

void PlantTask::HandleEvents(std::int64_t now_ns) noexcept {
  LinePress press{};
  while (channels_.presses->Pop(&press)) rig_.Press(press.line, press.level);

  const Permit& permit = channels_.permits->Read().At(now_ns - kPeriodNs).value;
  if (permit.running_since_ns == INT64_MIN) return;
  if (permit.running_since_ns != run_since_ns_) {
    run_since_ns_ = permit.running_since_ns;
    next_event_ = 0;
    change_number_ = 0;
    experiment_ = permit.run.experiment;
    released_.store(permit.run_number, std::memory_order_release);
    FreezeControlTask();
  }
  if (permit.change.number != change_number_) {
    change_number_ = permit.change.number;
    if (permit.change.experiment != nullptr) {  // the same events
      experiment_ = permit.change.experiment;
      released_.store(change_number_, std::memory_order_release);
    }
  }
  if (experiment_ == nullptr) return;
  const std::vector<SimEvent>& events = experiment_->sim_events;
  const std::int64_t start_ns = grid_.ExperimentStart(run_since_ns_);
  for (; next_event_ < events.size(); ++next_event_) {
    const SimEvent& event = events[next_event_];
    if (start_ns + std::llround(event.at_s * 1e9) > now_ns) return;
    if (event.line.has_value()) rig_.Press(*event.line, event.level);
    if (event.freeze == FreezeTarget::kPlant) frozen_ = true;
    if (event.kill) std::raise(SIGKILL);
    if (event.payload_kg) rig_.CarryPayload(*event.payload_kg);
  }
}

void PlantTask::FreezeControlTask() noexcept {
  if (experiment_ == nullptr) return;
  for (const SimEvent& event : experiment_->sim_events) {
    if (event.freeze != FreezeTarget::kControl) continue;
    channels_.control->FreezeFrom(grid_.ExperimentStart(run_since_ns_) +
                                  std::llround(event.at_s * 1e9));
    return;
  }
}

void PlantTask::StartFrame(std::int64_t now_ns) noexcept {
  rig_.StartFrame(now_ns);
  packet_ns_ = now_ns;
  packet_lost_ = loss_.Next();
  for (std::size_t i = 0; i < 2; ++i) {
    packet_.applied_torque_nm[i] = applied_slices_ > 0 ? applied_sum_nm_[i] / applied_slices_ : 0.0;
  }
  applied_sum_nm_ = {};
  applied_slices_ = 0;
  const CommandHistory::Entry& put_out = channels_.commands->Read().At(now_ns);
  packet_.output_tick = put_out.value.tick;
  packet_.acted_ns = put_out.from_ns + grid_.actuation_ns;
  packet_.gate_reasons = gate_reasons_;
  gate_reasons_ = 0;
  channels_.truth->Push({.tick = now_ns / grid_.period_ns, .truth = rig_.truth()});
}

// Publishes the frame once the last channel of a multiplexed input has been sampled.
void PlantTask::PublishFrame() noexcept {
  const std::optional<SensorFrame> frame = rig_.TakeFrame();
  if (!frame) return;
  packet_.frame = *frame;
  if (packet_lost_) {
    packet_.frame = {};
    packet_.frame.sampled_at_ns = packet_ns_;
  }
  frames_.Push(packet_ns_, packet_);
  channels_.frames->PublishGrown(frames_);
}

}  // namespace flexarm
