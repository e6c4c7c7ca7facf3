#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "hal/comedi/daq_board.h"

namespace flexarm {

/// Identity and timing of a simulated board.
struct SimulatedDaqConfig {
  DaqIdentity identity{.driver = "sim", .board = "sim-16"};
  int inputs = 16;
  int input_bits = 12;
  std::vector<DaqRange> input_ranges{{.lowest_v = -5.0, .highest_v = 5.0},
                                     {.lowest_v = -10.0, .highest_v = 10.0}};
  bool streams = true;
  int outputs = 2;
  int output_bits = 12;
  std::vector<DaqRange> output_ranges{{.lowest_v = -10.0, .highest_v = 10.0}};
  int counters = 4;
  int counter_bits = 24;
  int lines = 8;
  std::int64_t clock_step_ns = 1000;     ///< intervals of scans are multiples of it
  std::int64_t transfer_ns = 0;          ///< from a conversion until it can be read
  std::int64_t instruction_ns = 15'000;  ///< time of each single read or write
  std::int64_t read_ns = 5000;           ///< time of a read of the buffer
  std::size_t buffer_samples = 32768;    ///< 64 KiB
};

/// A DAQ board in memory, with its own time, which advances while a caller waits or calls, and by
/// AdvanceTo. The voltage of an input is a function of channel and time, converted at the instant
/// of the conversion; as on a real board the scan continues whether it is read or not, a full
/// buffer ends it, and outputs keep their voltage when the board is closed.
/// Subdevices: 0 inputs, 1 outputs, 2 lines, 3 counters.
class SimulatedDaqBoard final : public DaqBoard {
 public:
  explicit SimulatedDaqBoard(const SimulatedDaqConfig& config = {});

  const char* device() const noexcept override { return "/dev/simulated"; }
  std::int64_t now_ns() const noexcept override { return now_ns_; }
  DaqIdentity Open() override;
  DaqSubdevice Describe(int subdevice) override;
  std::vector<DaqRange> Ranges(int subdevice, int channel) override;
  bool Lock(int subdevice) override;
  bool SetInput(int subdevice, int channel) override;
  DaqScan SetScan(const DaqScan& scan) override;
  [[nodiscard]] DaqResult StartScan() noexcept override;
  void StopScan() noexcept override;
  [[nodiscard]] DaqResult ReadScan(std::span<std::uint32_t> samples,
                                   std::size_t* count) noexcept override;
  void WaitUntil(std::int64_t instant_ns) noexcept override;
  [[nodiscard]] DaqResult Read(const DaqChannel& channel, std::uint32_t* value) noexcept override;
  [[nodiscard]] DaqResult Write(const DaqChannel& channel, std::uint32_t value) noexcept override;
  [[nodiscard]] DaqResult ReadBits(int subdevice, std::uint32_t* bits) noexcept override;
  void Close() noexcept override { open_ = running_ = false; }

  void AdvanceTo(std::int64_t instant_ns) noexcept;

  // Environment of the board.
  void SetVoltage(std::function<double(int channel, std::int64_t at_ns)> voltage);
  std::array<std::uint32_t, 4> counter{};
  std::uint32_t lines = 0;
  /// Voltage at an amplifier: by comedi's rule, lowest + code / (2^bits - 1) * span.
  double output_v(int channel) const;

  // Injected faults.
  bool gone = false;
  std::uint32_t stray_bits = 0;  ///< set in every code of an input
  bool refuse_reads = false;
  bool refuse_writes = false;
  bool refuse_start = false;
  bool outputs_ignore = false;        ///< writing 0 V has no effect
  int held_subdevice = -1;            ///< locked by another program
  std::int64_t instruction_takes_ns;  ///< from the config; longer for a stuck board
  double pace = 1.0;                  ///< rate of the board's clock relative to ours
  void StopConverting() noexcept { converting_ = false; }  ///< the scan runs without samples
  void EndScan() noexcept { running_ = false; }            ///< the board ends the scan

  bool running() const noexcept { return running_; }
  bool open() const noexcept { return open_; }
  int instructions() const noexcept { return instructions_; }

 private:
  void Convert() noexcept;
  std::uint32_t CodeOf(const DaqChannel& channel, std::int64_t at_ns) const noexcept;
  DaqResult Spend() noexcept;

  SimulatedDaqConfig config_;
  std::int64_t now_ns_ = 1'000'000'000;
  std::function<double(int, std::int64_t)> voltage_;
  std::vector<std::uint32_t> output_;
  DaqScan scan_{};
  bool open_ = false;
  bool running_ = false;
  bool converting_ = true;
  bool overrun_ = false;
  std::int64_t started_ns_ = 0;
  std::int64_t conversions_ = 0;  // since the start, of all channels
  std::vector<std::uint32_t> ring_;
  std::size_t first_ = 0, held_ = 0;  // unread samples in ring_
  int instructions_ = 0;
};

}  // namespace flexarm
