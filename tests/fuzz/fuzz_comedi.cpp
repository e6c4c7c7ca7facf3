#include <memory>
#include <utility>

#include "tests/fuzz/fuzz_reader.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/hal/comedi/comedi_bench.h"

namespace flexarm {
namespace {

// A board with the right identity whose driver returns what the input holds. As DaqBoard demands,
// time goes on.
class HostileBoard final : public DaqBoard {
 public:
  explicit HostileBoard(FuzzReader* from) : from_(from), lies_(from->Byte() % 4 == 0) {}

  const char* device() const noexcept override { return "/dev/hostile"; }
  std::int64_t now_ns() const noexcept override { return now_ns_; }
  DaqIdentity Open() override { return good_.Open(); }
  DaqSubdevice Describe(int subdevice) override {
    DaqSubdevice found = good_.Describe(subdevice);
    if (!lies_) return found;
    const std::uint8_t what = from_->Byte();
    if ((what & 1U) != 0) found.channels = static_cast<int>(from_->Number<std::uint32_t>());
    if ((what & 2U) != 0) found.bits = static_cast<int>(from_->Number<std::uint32_t>());
    if ((what & 4U) != 0) found.kind = DaqKind::kOther;
    if ((what & 8U) != 0) found.buffer_samples = from_->Number<std::uint64_t>();
    return found;
  }
  std::vector<DaqRange> Ranges(int subdevice, int channel) override {
    std::vector<DaqRange> ranges = good_.Ranges(subdevice, channel);
    if (lies_) ranges.resize(from_->Byte() % 3);
    return ranges;
  }
  bool Lock(int) override { return !lies_ || from_->Byte() < 0xF0; }
  bool SetInput(int, int) override { return !lies_ || from_->Byte() < 0xF0; }
  DaqScan SetScan(const DaqScan& scan) override {
    DaqScan set = good_.SetScan(scan);
    if (lies_ && from_->Byte() > 0xC0) {
      set.scan_interval_ns = static_cast<std::int64_t>(from_->Number<std::uint64_t>());
    }
    return set;
  }
  [[nodiscard]] DaqResult StartScan() noexcept override { return Result(); }
  void StopScan() noexcept override {}
  [[nodiscard]] DaqResult ReadScan(std::span<std::uint32_t> samples,
                                   std::size_t* count) noexcept override {
    *count = 0;
    const DaqResult result = Result();
    if (result != DaqResult::kOk) return result;
    const std::uint8_t size = from_->Byte();
    if (size == 0) return DaqResult::kNothing;
    *count = std::min<std::size_t>(size, samples.size());
    for (std::size_t i = 0; i < *count; ++i) samples[i] = Value();
    return DaqResult::kOk;
  }
  void WaitUntil(std::int64_t instant_ns) noexcept override {
    now_ns_ = std::max(now_ns_, instant_ns);
  }
  [[nodiscard]] DaqResult Read(const DaqChannel& channel, std::uint32_t* value) noexcept override {
    const bool output = channel.subdevice == 1;
    *value = output && !lies_ ? written_[static_cast<std::size_t>(channel.channel) % 2] : Value();
    return Result();
  }
  [[nodiscard]] DaqResult Write(const DaqChannel& channel, std::uint32_t value) noexcept override {
    written_[static_cast<std::size_t>(channel.channel) % 2] = value;
    return Result();
  }
  [[nodiscard]] DaqResult ReadBits(int, std::uint32_t* bits) noexcept override {
    *bits = Value();
    return Result();
  }
  void Close() noexcept override {}

 private:
  // Most bytes are a success after 15 us.
  DaqResult Result() noexcept {
    const std::uint8_t byte = from_->Byte();
    now_ns_ += byte >= 0xE0 ? (byte % 32) * kMillisecond : 15'000;
    switch (byte) {
      case 0xC0:
        return DaqResult::kNothing;
      case 0xC1:
        return DaqResult::kStopped;
      case 0xC2:
        return DaqResult::kOverrun;
      case 0xC3:
        return DaqResult::kFailed;
      case 0xC4:
        return DaqResult::kGone;
      default:
        return DaqResult::kOk;
    }
  }
  // Of 12 bits, or any.
  std::uint32_t Value() noexcept {
    const std::uint16_t low = from_->Number<std::uint16_t>();
    if (low < 0x1000) return low;
    return std::uint32_t{low} << 16U | from_->Number<std::uint16_t>();
  }

  FuzzReader* from_;
  bool lies_;  // of itself, too
  SimulatedDaqBoard good_;
  std::int64_t now_ns_ = 1'000'000'000;
  std::array<std::uint32_t, 2> written_{};
};

void Drive(FuzzReader* from, HostileBoard* board, ComediDevice* device) {
  SensorFrame frame{};
  constexpr int kMostPeriods = 50;
  for (int i = 0; i < kMostPeriods && !from->empty(); ++i) {
    const std::uint8_t plan = from->Byte();
    board->WaitUntil(board->now_ns() + plan / 8 * kMillisecond);
    BusStatus status = BusStatus::kOk;
    if ((plan & 1U) != 0) status = device->SwitchOff();
    if ((plan & 2U) != 0) {
      status = device->Reconnect();
    } else {
      status = device->Exchange({.torque_nm = {1.0, -1.0}, .enabled = (plan & 4U) != 0}, &frame);
    }
    if (status != BusStatus::kOk) device->FaultText(device->FaultOf(status));
  }
  device->Close();
}

}  // namespace

// The first byte: a board that scans by itself, or one that is read channel by channel.
void FuzzComedi(FuzzBytes input) {
  FuzzReader from(input);
  const ComediBoardConfig config = from.Byte() % 2 == 0 ? BenchBoard() : SingleReads();
  auto hostile = std::make_unique<HostileBoard>(&from);
  HostileBoard* board = hostile.get();
  ComediDevice device(config, std::move(hostile));
  try {
    device.Open();
  } catch (const HalError&) {
    return;
  }
  Drive(&from, board, &device);
}

}  // namespace flexarm
