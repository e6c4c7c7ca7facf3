#include "controller/tasks/control_task.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/tasks/follow_reference.h"
#include "controller/types/known_payload.h"

namespace flexarm {

ControlTask::ControlTask(const LoopConfig& loop, int window_periods, ControlStep* step,
                         ControlChannels channels)
    : grid_(loop), step_(step), channels_(std::move(channels)), missed_(window_periods) {}

Task::Traits ControlTask::traits() const noexcept {
  return {.name = "control",
          .period_ns = grid_.period_ns,
          .phase_ns = grid_.phase_ns,
          .deadline_ns = grid_.deadline_ns,
          .priority = kPriority};
}

// What has been decided since the last activation: whether that kept its deadline, and periods
// without an activation, which missed theirs.
void ControlTask::CountDeadlines(const Activation& activation) noexcept {
  const std::int64_t before_ns = std::exchange(due_before_ns_, activation.due_ns);
  if (before_ns == INT64_MIN) return;
  const std::int64_t skipped = (activation.due_ns - before_ns) / grid_.period_ns - 1;
  missed_.Push(activation.missed_in_a_row > skipped);
  missed_.PushFailures(skipped);
}

void ControlTask::Run(const Activation& activation) noexcept {
  CountDeadlines(activation);
  // Values published at the due instant itself may not be visible yet.
  const std::int64_t seen_ns = activation.due_ns - 1;
  const PermitHistory& permits = channels_.permits->Read();
  FollowState(permits.At(seen_ns).value);
  // A switch that was open for a moment since the last step counts as open.
  permits.ForEach(seen_ns - grid_.period_ns, seen_ns, [this](const Permit& permit) {
    levels_ = MergeRedundantLevels(levels_, permit.levels);
  });
  const std::int64_t sampled_ns = grid_.SamplingInstant(grid_.Tick(activation.due_ns));
  const FramePacket packet = ReadFrames(sampled_ns);

  TickRecord record{};
  record.input = Gather(activation, packet, state_);
  record.output = step_->Step(record.input);
  record.gate_reasons = packet.gate_reasons;
  record.run_number = run_number_;
  record.change_number = change_number_;
  record.sample = sample_;
  counts_ = record.output.counts;
  delay_found_ = int{record.output.delay_found};
  known_ = KnownPayload(record.output);
  hub_angle_rad_ = {record.output.angle_rad[0], record.output.angle_rad[1]};
  Publish(activation, record.input, record.output);
  if (PlansAhead(record.input)) {
    channels_.planner->Ask(sample_ + delay_found_, activation.due_ns, experiment_->reference,
                           record.output);
  }
  channels_.records->Push(record);
  channels_.operator_ticks->Push(record);
}

FramePacket ControlTask::ReadFrames(std::int64_t sampled_ns) noexcept {
  FramePacket packet = channels_.frames.front()->Read().At(sampled_ns).value;
  for (std::size_t i = 1; i < channels_.frames.size(); ++i) {
    Join(channels_.frames[i]->Read().At(sampled_ns).value, &packet);
  }
  return packet;
}

void ControlTask::FollowState(const Permit& permit) noexcept {
  reset_ = reset_ || (DrivesEnabled(permit.state) && !DrivesEnabled(state_));
  if (permit.state == SafetyState::kRunning) {
    FollowRun(permit);
  }
  state_ = permit.state;
  levels_ = permit.levels;
  reduced_ = permit.reduced;
  if (!TorqueAllowed(state_)) TakeCalibration();
}

void ControlTask::FollowRun(const Permit& permit) noexcept {
  if (permit.run_number != run_number_) StartRun(permit);
  if (permit.change.number != change_seen_) TakeChange(permit.change);
  if (experiment_ == nullptr || sample_ < experiment_->reference.holds_at()) ++sample_;
}

// Until its first sample the new path is the old one, so a change that comes in time is no step.
// The safety task grants no other.
void ControlTask::TakeChange(const RunChange& change) noexcept {
  change_seen_ = change.number;
  if (change.experiment == nullptr) return;
  if (sample_ + kChangeLead / 2 >= change.experiment->changes_at) return;
  experiment_ = change.experiment;
  change_number_ = change.number;
  reference_.Continue(&experiment_->reference);
  released_.store(change.number, std::memory_order_release);
}

void ControlTask::TakeCalibration() noexcept {
  const Calibration& newest = channels_.calibrations->Read();
  if (newest == calibration_) return;
  calibration_ = newest;
  reset_ = true;
}

void ControlTask::StartRun(const Permit& permit) noexcept {
  experiment_ = permit.run.experiment;
  run_number_ = permit.run_number;
  released_.store(run_number_, std::memory_order_release);
  change_number_ = change_seen_ = 0;
  sample_ = -1;
  reset_ = true;
  if (experiment_ != nullptr) {
    reference_.Start(&experiment_->reference, &experiment_->load_change);
  }
  if (channels_.planner != nullptr) channels_.planner->Start(run_number_);
  if (experiment_ != nullptr && experiment_->mode == LoopMode::kRegulate) {
    homing_.Start(experiment_->homing, hub_angle_rad_);
  }
}

StepInput ControlTask::Gather(const Activation& activation, const FramePacket& packet,
                              SafetyState state) noexcept {
  StepInput input{};
  input.tick = grid_.Tick(activation.due_ns);
  input.now_ns = activation.due_ns;
  input.sampling_instant_ns = grid_.SamplingInstant(input.tick);
  input.frame = packet.frame;
  input.applied_torque_nm = packet.applied_torque_nm;
  const bool measured = packet.output_tick >= 0 && packet.output_tick == input.tick - 1;
  const std::int64_t late_ns = grid_.late_ns();
  input.acted_late_ns = measured ? std::clamp(packet.acted_ns - input.sampling_instant_ns, late_ns,
                                              late_ns + grid_.period_ns)
                                 : late_ns;
  input.acts_late_ns = input.acted_late_ns;
  input.frame.levels = levels_;
  input.counts_before = counts_;
  input.calibration = calibration_;
  input.safety_state = state;
  input.reset = reset_ ? 1 : 0;
  input.reduced = reduced_ ? 1 : 0;
  if (reset_) delay_found_ = 0;
  reset_ = false;
  if (TorqueAllowed(state)) Follow(state, &input);
  return input;
}

void ControlTask::Follow(SafetyState state, StepInput* input) noexcept {
  if (experiment_ == nullptr) {  // no reference: end at once, at the hub angles
    input->reference_now.x_m[0] = input->reference_next.x_m[0] = hub_angle_rad_[0];
    input->reference_now.x_m[1] = input->reference_next.x_m[1] = hub_angle_rad_[1];
    input->reference_ended = 1;
    return;
  }
  input->mode = experiment_->mode;
  if (input->mode == LoopMode::kRegulate) {
    input->reference_next = homing_.Next(levels_, hub_angle_rad_);
    input->reference_ended = homing_.ended() ? 1 : 0;
    return;
  }
  const int last = reference_.periods() - 1;
  if (state == SafetyState::kStopping && sample_ >= last) sample_ = last + 1;  // rest after the end
  // In open loop each torque of the sequence is put out once, so the delay found does not shift it.
  const int acts = input->mode == LoopMode::kFollow ? sample_ + delay_found_ : sample_;
  reference_.Choose(acts, known_);
  FollowReference(reference_, grid_, sample_, acts, input);
  if (PlansAhead(*input)) FollowPlan(input);
}

bool ControlTask::PlansAhead(const StepInput& input) const noexcept {
  return channels_.planner != nullptr && experiment_ != nullptr && !experiment_->keeps_own_time &&
         input.safety_state == SafetyState::kRunning && input.mode == LoopMode::kFollow;
}

void ControlTask::FollowPlan(StepInput* input) noexcept {
  const std::optional<MotionSample> plan =
      channels_.planner->At(sample_ + delay_found_, input->now_ns);
  if (!plan) return;
  input->plan = *plan;
  input->planned = 1;
}

void ControlTask::Publish(const Activation& activation, const StepInput& input,
                          const StepOutput& output) noexcept {
  const std::int64_t published_ns = activation.due_ns + grid_.deadline_ns;
  const std::int64_t put_out_ns =
      input.sampling_instant_ns + grid_.period_ns + grid_.output_late_ns;
  // A zero after a fault acts at once; damping torque is predicted for the usual instant.
  const bool cut = output.faults != 0 && !Damped(output.faults, output.may_damp != 0);
  commands_.Push(cut ? published_ns : put_out_ns,
                 {.torque_nm = output.torque_nm, .tick = output.tick});
  for (CommandChannel* channel : channels_.commands) channel->Publish(commands_);
  reports_.Push(published_ns, {.tick = output.tick,
                               .due_ns = activation.due_ns,
                               .faults = output.faults,
                               .evidence = {.value = output.fault_value,
                                            .limit = output.fault_limit,
                                            .channel = output.fault_channel,
                                            .detail = 0},
                               .at_rest = output.at_rest != 0,
                               .experiment_done = output.experiment_done != 0,
                               .missed_in_a_row = activation.missed_in_a_row,
                               .may_damp = output.may_damp != 0,
                               .missed_in_window = missed_.count()});
  channels_.reports->Publish(reports_);
}

}  // namespace flexarm
