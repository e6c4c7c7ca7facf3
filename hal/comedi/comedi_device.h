#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "hal/bus_device.h"
#include "hal/comedi/board_proof.h"
#include "hal/comedi/comedi_config.h"
#include "hal/comedi/comedi_fault.h"
#include "hal/comedi/comedi_plan.h"
#include "hal/comedi/daq_board.h"
#include "hal/comedi/scan_clock.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Driver of a DAQ board: gauges on analogue inputs, amplifiers on analogue outputs, encoders on
/// counters.
///
/// One exchange: a voltage to each amplifier; then the newest complete scan of the streamed inputs,
/// or one read per input; then the counters and lines, one read each. sampled_at_ns is the instant
/// after the outputs. A streamed reading is older than that, by its offset: ScanClock estimates the
/// end of the scan, and every channel is sampled convert_interval before the next. A single read
/// has the instant of its middle.
///
/// Torque is sent only while enabled and before the command expires; the output is 0 V otherwise,
/// while a fault lasts, and on Close. An output keeps its last voltage when this process dies: then
/// the relay and the charge pump of the safety chain stop the arm.
///
/// The duration of an instruction depends on the board: comedi lets a stuck one busy-wait for a
/// second at most, and no program can shorten that. After the first read that exceeds the declared
/// time, an exchange reads nothing more; it always writes the outputs. So the bound holds for a
/// board that keeps instruction_us; beyond it, at most one stuck instruction per output can follow.
/// Real-time: Exchange, Reconnect and Close do not allocate; reading the stream does not wait.
/// Thread: the bus's own.
class ComediDevice final : public BusDevice {
 public:
  /// @param config  without problems
  ComediDevice(ComediBoardConfig config, std::unique_ptr<DaqBoard> board);
  ~ComediDevice() override { Close(); }
  ComediDevice(const ComediDevice&) = delete;
  ComediDevice& operator=(const ComediDevice&) = delete;

  const char* name() const noexcept override { return config_.device.c_str(); }
  std::uint32_t drives() const noexcept override { return drives_; }
  /// An amplifier confirms nothing: those that the last output was allowed to command.
  std::uint32_t drives_on() const noexcept override { return on_ ? drives_ : 0; }
  LineLevels lines() const noexcept override { return lines_; }
  /// Of an exchange, or of a reconnection, whichever is longer.
  std::int64_t worst_case_ns() const noexcept override;

  /// Identifies the board, reads its whole configuration back, starts the scan and reads every
  /// channel once.
  /// @throws HalError naming the device, what was found and what was expected
  void Open() override;

  [[nodiscard]] BusStatus Exchange(const BusCommand& command, SensorFrame* part) noexcept override;

  /// Sets 0 V.
  [[nodiscard]] BusStatus SwitchOff() noexcept override;

  /// Sets 0 V and restarts the scan; a later call returns kOk once a scan has arrived. A board that
  /// is gone stays gone: opening it again would allocate.
  [[nodiscard]] BusStatus Reconnect() noexcept override;

  /// node: 1 + the channel's index in plan().channels, 0: the board.
  BusFault FaultOf(BusStatus status) const noexcept override;
  std::string FaultText(const BusFault& fault) const override;

  void Close() noexcept override;

  /// Fault of the last exchange, or the latched one.
  ComediFault fault() const noexcept { return fault_; }
  const ComediPlan& plan() const noexcept { return plan_; }

 private:
  /// At most kMostReads of kChunk samples are read; more than that means that the stream was not
  /// read for too long.
  static constexpr std::size_t kChunk = 4096;
  static constexpr int kMostReads = 10;
  static constexpr std::size_t kNoChannel = 254;  ///< there are fewer

  bool streams() const noexcept { return plan_.oldest_ns > 0; }
  void Fail(ComediFault fault, std::size_t channel = kNoChannel) noexcept;
  void BeyondRange(std::size_t input) noexcept;
  bool Went(DaqResult result, ComediFault refused, std::size_t channel) noexcept;
  void Drive(const BusCommand& command) noexcept;
  void ReadAll(SensorFrame* fresh) noexcept;
  void ReadStream(SensorFrame* fresh) noexcept;
  std::int64_t Drain() noexcept;
  void ReadSingles(SensorFrame* fresh) noexcept;
  void ReadCounters(SensorFrame* fresh) noexcept;
  void ReadLines(SensorFrame* fresh) noexcept;
  bool ReadOne(const DaqChannel& channel, std::size_t number, std::int64_t sampled_at_ns,
               std::uint32_t* value, std::int32_t* offset_ns) noexcept;
  void StartStream() noexcept;
  void AwaitFirstScan();

  ComediBoardConfig config_;
  ComediPlan plan_;
  std::unique_ptr<DaqBoard> board_;
  ComediChannels channels_;
  ScanClock scan_clock_;
  std::uint32_t drives_ = 0;
  LineLevels lines_ = 0;
  bool open_ = false;
  bool on_ = false;          // the last output could be a torque
  bool restarting_ = false;  // Reconnect waits for the first scan
  ComediFault fault_ = ComediFault::kNone;
  std::size_t fault_channel_ = kNoChannel;  // index in plan_.channels
  std::int64_t begin_ns_ = 0;               // start of this exchange
  std::array<std::uint32_t, kChunk> samples_{};
  std::array<std::uint32_t, kMaxStrainChannels> partial_{};  // the scan that is being received
  std::array<std::uint32_t, kMaxStrainChannels> newest_{};
  std::size_t position_ = 0;  // index in partial_
  SensorFrame last_{};        // good values, repeated while there are no new ones
};

}  // namespace flexarm
