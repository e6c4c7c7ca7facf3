#include "tests/hal/comedi/simulated_daq_board.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flexarm {

SimulatedDaqBoard::SimulatedDaqBoard(const SimulatedDaqConfig& config)
    : instruction_takes_ns(config.instruction_ns),
      config_(config),
      voltage_([](int, std::int64_t) { return 0.0; }),
      output_(static_cast<std::size_t>(config.outputs), 0),
      ring_(config.buffer_samples) {}

DaqIdentity SimulatedDaqBoard::Open() {
  if (gone) throw HalError("comedi /dev/simulated: cannot be opened: No such device");
  open_ = true;
  return config_.identity;
}

DaqSubdevice SimulatedDaqBoard::Describe(int subdevice) {
  switch (subdevice) {
    case 0:
      return {.kind = DaqKind::kAnalogInput,
              .channels = config_.inputs,
              .bits = config_.input_bits,
              .streams = config_.streams,
              .buffer_samples = config_.buffer_samples};
    case 1:
      return {DaqKind::kAnalogOutput, config_.outputs, config_.output_bits, false, 0};
    case 2:
      return {DaqKind::kDigital, config_.lines, 1, false, 0};
    case 3:
      return {DaqKind::kCounter, config_.counters, config_.counter_bits, false, 0};
    default:
      return {DaqKind::kNone, 0, 0, false, 0};
  }
}

std::vector<DaqRange> SimulatedDaqBoard::Ranges(int subdevice, int) {
  return subdevice == 0 ? config_.input_ranges : config_.output_ranges;
}

bool SimulatedDaqBoard::Lock(int subdevice) { return subdevice != held_subdevice; }

bool SimulatedDaqBoard::SetInput(int, int channel) { return channel < config_.lines; }

DaqScan SimulatedDaqBoard::SetScan(const DaqScan& scan) {
  const auto rounded = [this](std::int64_t ns) {
    return (ns + config_.clock_step_ns / 2) / config_.clock_step_ns * config_.clock_step_ns;
  };
  scan_ = scan;
  scan_.scan_interval_ns = rounded(scan.scan_interval_ns);
  scan_.convert_interval_ns = rounded(scan.convert_interval_ns);
  return scan_;
}

DaqResult SimulatedDaqBoard::StartScan() noexcept {
  if (gone) return DaqResult::kGone;
  if (refuse_start || running_) return DaqResult::kFailed;
  running_ = converting_ = true;
  overrun_ = false;
  started_ns_ = now_ns_;
  conversions_ = 0;
  held_ = 0;
  return DaqResult::kOk;
}

void SimulatedDaqBoard::StopScan() noexcept {
  running_ = false;
  held_ = 0;
}

// The first scan begins an interval after the start.
void SimulatedDaqBoard::Convert() noexcept {
  const auto channels = static_cast<std::int64_t>(scan_.channel.size());
  while (running_ && converting_ && !gone) {
    const std::int64_t own_ns = (conversions_ / channels + 1) * scan_.scan_interval_ns +
                                conversions_ % channels * scan_.convert_interval_ns;
    const std::int64_t at_ns = started_ns_ + std::llround(static_cast<double>(own_ns) / pace);
    if (at_ns + config_.transfer_ns > now_ns_) return;
    if (held_ == ring_.size()) {
      overrun_ = true;
      running_ = false;
      return;
    }
    const DaqChannel& channel = scan_.channel[static_cast<std::size_t>(conversions_ % channels)];
    ring_[(first_ + held_++) % ring_.size()] = CodeOf(channel, at_ns);
    ++conversions_;
  }
}

std::uint32_t SimulatedDaqBoard::CodeOf(const DaqChannel& channel,
                                        std::int64_t at_ns) const noexcept {
  const DaqRange& range = config_.input_ranges[static_cast<std::size_t>(channel.range)];
  const double steps = std::ldexp(1.0, config_.input_bits);
  const double volts = voltage_(channel.channel, at_ns);
  const double code =
      std::floor((volts - range.lowest_v) / (range.highest_v - range.lowest_v) * steps + 0.5);
  return static_cast<std::uint32_t>(std::clamp(code, 0.0, steps - 1.0)) | stray_bits;
}

DaqResult SimulatedDaqBoard::ReadScan(std::span<std::uint32_t> samples,
                                      std::size_t* count) noexcept {
  AdvanceTo(now_ns_ + config_.read_ns);
  *count = 0;
  if (gone) return DaqResult::kGone;
  if (held_ == 0) {
    return running_ ? DaqResult::kNothing : overrun_ ? DaqResult::kOverrun : DaqResult::kStopped;
  }
  while (held_ > 0 && *count < samples.size()) {
    samples[(*count)++] = ring_[first_];
    first_ = (first_ + 1) % ring_.size();
    --held_;
  }
  return DaqResult::kOk;
}

void SimulatedDaqBoard::WaitUntil(std::int64_t instant_ns) noexcept {
  if (held_ == 0) AdvanceTo(std::max(instant_ns, now_ns_));
}

DaqResult SimulatedDaqBoard::Spend() noexcept {
  ++instructions_;
  AdvanceTo(now_ns_ + instruction_takes_ns);
  return gone ? DaqResult::kGone : DaqResult::kOk;
}

DaqResult SimulatedDaqBoard::Read(const DaqChannel& channel, std::uint32_t* value) noexcept {
  const std::int64_t middle_ns = now_ns_ + instruction_takes_ns / 2;
  const DaqResult result = Spend();
  if (result != DaqResult::kOk) return result;
  if (refuse_reads) return DaqResult::kFailed;
  const auto at = static_cast<std::size_t>(channel.channel);
  *value = channel.subdevice == 0   ? CodeOf(channel, middle_ns)
           : channel.subdevice == 1 ? output_[at]
                                    : counter[at];
  return DaqResult::kOk;
}

DaqResult SimulatedDaqBoard::Write(const DaqChannel& channel, std::uint32_t value) noexcept {
  const DaqResult result = Spend();
  if (result != DaqResult::kOk) return result;
  if (refuse_writes) return DaqResult::kFailed;
  if (!outputs_ignore) output_[static_cast<std::size_t>(channel.channel)] = value;
  return DaqResult::kOk;
}

DaqResult SimulatedDaqBoard::ReadBits(int, std::uint32_t* bits) noexcept {
  const DaqResult result = Spend();
  if (result != DaqResult::kOk) return result;
  *bits = lines;
  return refuse_reads ? DaqResult::kFailed : DaqResult::kOk;
}

void SimulatedDaqBoard::AdvanceTo(std::int64_t instant_ns) noexcept {
  now_ns_ = instant_ns;
  Convert();
}

void SimulatedDaqBoard::SetVoltage(std::function<double(int, std::int64_t)> voltage) {
  voltage_ = std::move(voltage);
}

double SimulatedDaqBoard::output_v(int channel) const {
  const DaqRange& range = config_.output_ranges.front();
  const double most = std::ldexp(1.0, config_.output_bits) - 1.0;
  return range.lowest_v +
         output_[static_cast<std::size_t>(channel)] / most * (range.highest_v - range.lowest_v);
}

}  // namespace flexarm
