#include "hal/comedi/comedi_device.h"

#include <algorithm>
#include <string>
#include <utility>

#include "hal/comedi/daq_codec.h"

namespace flexarm {
namespace {

constexpr BusCommand kOff{.torque_nm = {}, .enabled = false};

std::uint32_t Bit(int index) noexcept { return std::uint32_t{1} << static_cast<unsigned>(index); }

std::uint32_t DriveCode(const ComediOutputConfig& out, const ComediDriveConfig& drive,
                        double torque_nm) noexcept {
  const double torque = std::clamp(torque_nm, -drive.torque_range_nm, drive.torque_range_nm);
  return CodeFromVolts(drive.sign * torque / drive.torque_per_volt_nm(), out.range_v, out.bits);
}

ScanClock ClockOf(const ComediBoardConfig& config) {
  return config.input ? ScanClock(config.input->scan_interval_ns(), config.input->transfer_ns())
                      : ScanClock(0, 0);
}

}  // namespace

ComediDevice::ComediDevice(ComediBoardConfig config, std::unique_ptr<DaqBoard> board)
    : config_(std::move(config)),
      plan_(PlanComedi(config_)),
      board_(std::move(board)),
      scan_clock_(ClockOf(config_)) {
  for (const ComediLineConfig& row : config_.line) lines_ |= LineBit(row.line);
  if (!config_.output) return;
  for (const ComediDriveConfig& drive : config_.output->drive) drives_ |= Bit(drive.joint);
}

std::int64_t ComediDevice::worst_case_ns() const noexcept {
  return std::max(plan_.exchange_worst_ns, plan_.reconnect_worst_ns);
}

void ComediDevice::Open() {
  const DaqIdentity identity = board_->Open();
  open_ = true;
  channels_ = ProveComediBoard(config_, identity, board_.get());
  fault_ = ComediFault::kNone;
  if (streams()) AwaitFirstScan();
  SensorFrame part{};
  if (Exchange(kOff, &part) == BusStatus::kOk) return;
  throw HalError("comedi " + config_.device + ": the first exchange fails: " + ToString(fault_));
}

void ComediDevice::AwaitFirstScan() {
  StartStream();
  while (fault_ == ComediFault::kNone && !scan_clock_.running() && !scan_clock_.late()) {
    board_->WaitUntil(board_->now_ns() + config_.input->scan_interval_ns());
    const std::int64_t before_ns = board_->now_ns();
    const std::int64_t scans = Drain();
    scan_clock_.Take(before_ns, board_->now_ns(), scans);
  }
  if (scan_clock_.running()) return;
  if (fault_ == ComediFault::kNone) Fail(ComediFault::kLateScan);
  throw HalError("comedi " + config_.device + ": no scan has arrived: " + ToString(fault_) +
                 ", expected one every " +
                 std::to_string(config_.input->scan_interval_ns() / 1000) + " us");
}

void ComediDevice::StartStream() noexcept {
  position_ = 0;
  if (board_->StartScan() != DaqResult::kOk) Fail(ComediFault::kStartRefused);
  scan_clock_.Restart(board_->now_ns());
}

// Keeps the first fault: it is the cause.
void ComediDevice::Fail(ComediFault fault, std::size_t channel) noexcept {
  if (fault_ != ComediFault::kNone && fault != ComediFault::kGone) return;
  fault_ = fault;
  fault_channel_ = channel;
}

void ComediDevice::BeyondRange(std::size_t input) noexcept {
  Fail(ComediFault::kBeyondRange, channels_.drive.size() + input);
}

bool ComediDevice::Went(DaqResult result, ComediFault refused, std::size_t channel) noexcept {
  if (result != DaqResult::kOk) {
    const bool gone = result == DaqResult::kGone;
    Fail(gone ? ComediFault::kGone : refused, gone ? kNoChannel : channel);
  } else if (board_->now_ns() - begin_ns_ > plan_.exchange_worst_ns) {
    Fail(ComediFault::kSlow, channel);
  }
  return fault_ == ComediFault::kNone;
}

BusStatus ComediDevice::Exchange(const BusCommand& command, SensorFrame* part) noexcept {
  begin_ns_ = board_->now_ns();
  if (!Lasts(fault_)) fault_ = ComediFault::kNone;
  Drive(command);
  SensorFrame fresh = last_;
  fresh.counter_valid = 0;
  fresh.strain_valid = 0;
  fresh.levels = 0;
  *part = fresh;  // no reading is valid
  if (fault_ == ComediFault::kNone) ReadAll(&fresh);
  if (fault_ == ComediFault::kNone) {
    last_ = fresh;
    *part = fresh;
  }
  return StatusOf(fault_);
}

BusStatus ComediDevice::SwitchOff() noexcept {
  if (!open_) return BusStatus::kOk;
  begin_ns_ = board_->now_ns();
  Drive(kOff);
  return StatusOf(fault_);
}

void ComediDevice::Drive(const BusCommand& command) noexcept {
  if (!config_.output) return;
  const ComediOutputConfig& out = *config_.output;
  on_ = command.enabled && fault_ == ComediFault::kNone;
  for (std::size_t i = 0; i < channels_.drive.size(); ++i) {
    const ComediDriveConfig& drive = out.drive[i];
    const bool on =
        command.enabled && fault_ == ComediFault::kNone && board_->now_ns() <= command.expires_ns;
    const double torque_nm = on ? command.torque_nm[static_cast<std::size_t>(drive.joint)] : 0.0;
    const DaqResult result = board_->Write(channels_.drive[i], DriveCode(out, drive, torque_nm));
    static_cast<void>(Went(result, ComediFault::kOutputRefused, i));
    if (fault_ == ComediFault::kGone) return;
  }
}

void ComediDevice::ReadAll(SensorFrame* fresh) noexcept {
  fresh->sampled_at_ns = board_->now_ns();
  if (streams()) {
    ReadStream(fresh);
  } else {
    ReadSingles(fresh);
  }
  ReadCounters(fresh);
  ReadLines(fresh);
}

void ComediDevice::ReadStream(SensorFrame* fresh) noexcept {
  const std::int64_t before_ns = board_->now_ns();
  const std::int64_t scans = Drain();
  if (fault_ != ComediFault::kNone) return;
  scan_clock_.Take(before_ns, board_->now_ns(), scans);
  if (!scan_clock_.running() || scan_clock_.late()) return Fail(ComediFault::kLateScan);
  if (scan_clock_.early()) return Fail(ComediFault::kEarlyScan);
  const ComediInputConfig& in = *config_.input;
  std::int64_t offset_ns = scan_clock_.newest_end_ns() - plan_.scan_ns - fresh->sampled_at_ns;
  for (std::size_t i = 0; i < in.channel.size(); ++i) {
    const auto row = static_cast<std::size_t>(in.channel[i].strain);
    if (!IsCode(newest_[i], in.bits)) return BeyondRange(i);
    fresh->strain[row] = CountsFromCode(newest_[i], in.bits);
    fresh->strain_offset_ns[row] = static_cast<std::int32_t>(offset_ns);
    fresh->strain_valid |= Bit(in.channel[i].strain);
    offset_ns += in.convert_interval_ns();
  }
}

// Reads all samples in the board's buffer. Returns the number of completed scans.
std::int64_t ComediDevice::Drain() noexcept {
  const std::size_t channels = channels_.strain.size();
  std::int64_t scans = 0;
  for (int reads = 0; reads < kMostReads; ++reads) {
    std::size_t count = 0;
    const DaqResult result = board_->ReadScan(samples_, &count);
    if (result == DaqResult::kNothing) return scans;
    if (result == DaqResult::kOverrun) Fail(ComediFault::kOverrun);
    if (result == DaqResult::kStopped) Fail(ComediFault::kScanStopped);
    if (result == DaqResult::kFailed) Fail(ComediFault::kScanStopped);
    if (result == DaqResult::kGone) Fail(ComediFault::kGone);
    if (result != DaqResult::kOk) return 0;
    for (std::size_t i = 0; i < count; ++i) {
      partial_[position_++] = samples_[i];
      if (position_ < channels) continue;
      position_ = 0;
      newest_ = partial_;
      ++scans;
    }
  }
  Fail(ComediFault::kOverrun);  // samples arrive faster than they are read
  return 0;
}

bool ComediDevice::ReadOne(const DaqChannel& channel, std::size_t number,
                           std::int64_t sampled_at_ns, std::uint32_t* value,
                           std::int32_t* offset_ns) noexcept {
  if (fault_ != ComediFault::kNone) return false;
  const std::int64_t before_ns = board_->now_ns();
  const DaqResult result = board_->Read(channel, value);
  const std::int64_t middle_ns = before_ns + (board_->now_ns() - before_ns) / 2;
  *offset_ns = static_cast<std::int32_t>(middle_ns - sampled_at_ns);
  return Went(result, ComediFault::kReadRefused, number);
}

void ComediDevice::ReadSingles(SensorFrame* fresh) noexcept {
  for (std::size_t i = 0; i < channels_.strain.size(); ++i) {
    const int strain = config_.input->channel[i].strain;
    const auto row = static_cast<std::size_t>(strain);
    std::uint32_t code = 0;
    if (!ReadOne(channels_.strain[i], channels_.drive.size() + i, fresh->sampled_at_ns, &code,
                 &fresh->strain_offset_ns[row])) {
      return;
    }
    if (!IsCode(code, config_.input->bits)) return BeyondRange(i);
    fresh->strain[row] = CountsFromCode(code, config_.input->bits);
    fresh->strain_valid |= Bit(strain);
  }
}

void ComediDevice::ReadCounters(SensorFrame* fresh) noexcept {
  const std::size_t first = channels_.drive.size() + channels_.strain.size();
  for (std::size_t i = 0; i < channels_.counter.size(); ++i) {
    const int counter = config_.counter[i].counter;
    const auto at = static_cast<std::size_t>(counter);
    if (!ReadOne(channels_.counter[i], first + i, fresh->sampled_at_ns, &fresh->counter[at],
                 &fresh->counter_offset_ns[at])) {
      return;
    }
    fresh->counter_valid |= Bit(counter);
  }
}

void ComediDevice::ReadLines(SensorFrame* fresh) noexcept {
  const std::size_t first = plan_.channels.size() - config_.line.size();
  for (const int subdevice : channels_.line_subdevice) {
    if (fault_ != ComediFault::kNone) return;
    std::uint32_t bits = 0;
    if (!Went(board_->ReadBits(subdevice, &bits), ComediFault::kReadRefused, first)) return;
    for (const ComediLineConfig& row : config_.line) {
      const bool high = (bits & Bit(row.channel)) != 0;
      if (row.subdevice == subdevice && high) fresh->levels |= LineBit(row.line);
    }
  }
}

BusStatus ComediDevice::Reconnect() noexcept {
  if (fault_ == ComediFault::kGone) return StatusOf(fault_);
  begin_ns_ = board_->now_ns();
  fault_ = ComediFault::kNone;
  Drive(kOff);
  if (!restarting_ && fault_ == ComediFault::kNone) {
    board_->StopScan();
    if (streams()) StartStream();
    restarting_ = fault_ == ComediFault::kNone;
    if (restarting_) Fail(ComediFault::kStarting);
    return StatusOf(fault_);
  }
  SensorFrame fresh = last_;
  if (fault_ == ComediFault::kNone) ReadAll(&fresh);
  restarting_ = fault_ == ComediFault::kLateScan && !scan_clock_.late();
  if (restarting_) fault_ = ComediFault::kStarting;
  return StatusOf(fault_);
}

BusFault ComediDevice::FaultOf(BusStatus) const noexcept {
  const bool of_channel = fault_channel_ < plan_.channels.size();
  return {.kind = static_cast<std::uint8_t>(fault_),
          .node = static_cast<std::uint8_t>(of_channel ? fault_channel_ + 1 : 0),
          .code = 0};
}

std::string ComediDevice::FaultText(const BusFault& fault) const {
  std::string text = config_.device + ": ";
  if (fault.node > 0 && fault.node <= plan_.channels.size()) {
    text += plan_.channels[fault.node - std::size_t{1}].channel + ": ";
  }
  return text + ToString(static_cast<ComediFault>(fault.kind));
}

void ComediDevice::Close() noexcept {
  if (!open_) return;
  open_ = false;
  begin_ns_ = board_->now_ns();
  Drive(kOff);
  board_->StopScan();
  board_->Close();
}

}  // namespace flexarm
