#include "tools/torture/tortured_stack.h"

#include <algorithm>
#include <cmath>

namespace flexarm {

namespace {

void CountOneMore(const EncoderConfig& encoder, SensorFrame* frame) {
  std::uint32_t& counter = frame->counter[static_cast<std::size_t>(encoder.counter)];
  counter = (counter + 1) & static_cast<std::uint32_t>((1ULL << encoder.counter_bits) - 1);
}

}  // namespace

TorturedPlant::TorturedPlant(const RigConfig& config, PlantTask* plant, const Channels& channels,
                             const std::vector<Fault>& faults)
    : config_(config),
      plant_(plant),
      channels_(channels),
      faults_(&faults),
      spoiled_frames_(config, faults),
      spoiled_torque_(config, faults),
      period_ns_(config.loop.period_ns()) {}

void TorturedPlant::Run(const Activation& activation) noexcept {
  PassCommands();
  plant_->Run(activation);
  PassFrames();
  PassReports(activation.due_ns);
}

void TorturedPlant::PassCommands() noexcept {
  const CommandHistory::Entry& newest = channels_.asked->Read().Newest();
  if (newest.from_ns == command_ns_ || newest.from_ns == INT64_MIN) return;
  command_ns_ = newest.from_ns;
  const CommandHistory::Entry spoiled = spoiled_torque_.Next(newest);
  commands_.Push(spoiled.from_ns, spoiled.value);
  channels_.commands->Publish(commands_);
}

void TorturedPlant::PassFrames() noexcept {
  const FrameHistory& sampled = channels_.sampled->Read();
  const std::int64_t until_ns = sampled.Newest().from_ns;
  if (until_ns == frame_ns_) return;
  // A plant that was late has sampled several frames at once.
  for (std::int64_t at_ns = frame_ns_ == INT64_MIN ? until_ns : frame_ns_ + period_ns_;
       at_ns <= until_ns; at_ns += period_ns_) {
    const FrameHistory::Entry& entry = sampled.At(at_ns);
    if (entry.from_ns != at_ns) continue;  // too old: no longer in the history
    FramePacket packet = entry.value;
    strain_share_ = StrainShare(packet.frame);
    packet.frame = spoiled_frames_.Next(packet.frame, at_ns);
    if (flickers_ != nullptr && at_ns / period_ns_ % 2 != 0)
      CountOneMore(*flickers_, &packet.frame);
    frames_.Push(at_ns, packet);
  }
  frame_ns_ = until_ns;
  channels_.frames->Publish(frames_);
}

double TorturedPlant::StrainShare(const SensorFrame& sampled) const noexcept {
  const SensorConfig& sensors = config_.sensors;
  double share = 0.0;
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    if ((sampled.strain_valid >> i & 1U) == 0) continue;
    const StrainChannelConfig& row = sensors.strain[i];
    const double strain = (sampled.strain[i] - row.offset_counts) *
                          sensors.strain_input.volts_per_count() / row.gain_v_per_unit;
    const auto link = static_cast<std::size_t>(row.link - 1);
    share = std::max(share, std::fabs(strain) / config_.safety.strain_limit[link]);
  }
  return share;
}

void TorturedPlant::PassReports(std::int64_t due_ns) noexcept {
  const DriveReportHistory::Entry& newest = channels_.told->Read().Newest();
  DriveReport report = newest.value;
  std::int64_t from_ns = newest.from_ns;
  ++reported_;
  for (const Fault& fault : *faults_) {
    if (!IsActive(fault, due_ns)) continue;
    const bool odd = reported_ % 2 == 1;
    if (fault.place == FaultPlace::kDriveReport) {
      report.drive_ok = fault.kind == FaultKind::kIntermittent && odd;
    }
    if (fault.place != FaultPlace::kBusReport) continue;
    if (fault.kind == FaultKind::kStuck) return;  // nothing is reported
    if (fault.kind == FaultKind::kOff) report.bus_ok = false;
    if (fault.kind == FaultKind::kIntermittent) report.bus_ok = odd;
    if (fault.kind == FaultKind::kLate) from_ns += period_ns_;
    if (fault.kind == FaultKind::kDelayed) from_ns += 3 * period_ns_;
  }
  reports_.Push(std::max(from_ns, reports_.Newest().from_ns), report);
  channels_.reports->Publish(reports_);
}

TorturedStack::TorturedStack(const RigConfig& config, const RigConfig& plant, const Design& design,
                             double payload_kg, const std::vector<Fault>& faults)
    : TorturedWires(faults),
      LoopStack(config, design,
                {.lines = &faulty_lines,
                 .frames = {&frames},
                 .commands = {&asked},
                 .permits = {&permits},
                 .drives = {&drive_reports}}),
      control_(&LoopStack::control()),
      plant_(plant, payload_kg, {0.0, 0.0},
             {.commands = &commands,
              .permits = &permits,
              .outputs = &outputs,
              .presses = &presses,
              .frames = &sampled,
              .levels = &levels,
              .reports = &told,
              .truth = &truth,
              .control = &control_}),
      side_(config, &plant_,
            {.asked = &asked,
             .commands = &commands,
             .sampled = &sampled,
             .frames = &frames,
             .told = &told,
             .reports = &drive_reports},
            faults) {}

WatchSample TorturedStack::Sample() noexcept {
  return {.status = status(),
          .told = faulty_lines.told(),
          .torque_nm = plant_.drive_torque_nm(),
          .arm_ns = plant_.integrated_ns(),
          .truth = plant_.rig().truth(),
          .strain_share = side_.strain_share()};
}

std::uint32_t TorturedStack::released_experiments() const noexcept {
  return std::min(LoopStack::released_experiments(), plant_.released());
}

}  // namespace flexarm
