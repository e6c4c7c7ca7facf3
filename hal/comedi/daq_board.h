#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/bus_device.h"

namespace flexarm {

/// What a subdevice of a board is for.
enum class DaqKind : std::uint8_t {
  kAnalogInput,
  kAnalogOutput,
  kDigital,
  kCounter,
  kOther,
  kNone,  ///< the board has no subdevice of that number
};

/// What a board says of itself, and of one of its subdevices.
struct DaqIdentity {
  std::string driver;
  std::string board;
};
struct DaqSubdevice {
  DaqKind kind;
  int channels;
  int bits;                    ///< values are 0 .. 2^bits - 1; 0: some other range
  bool streams;                ///< can scan by its own clock
  std::size_t buffer_samples;  ///< between the board and us; 0 without streaming
};

/// An input or output range.
struct DaqRange {
  double lowest_v;
  double highest_v;
};

/// What a voltage is measured against; the value is comedi's AREF.
enum class DaqReference : std::uint8_t { kGround = 0, kCommon = 1, kDifferential = 2 };

/// One channel, and how it is to be read or written.
struct DaqChannel {
  int subdevice;
  int channel;
  int range;  ///< index of DaqBoard::Ranges
  DaqReference reference;
};

/// A scan of several inputs of one subdevice, repeated without end by the board's clock.
struct DaqScan {
  std::vector<DaqChannel> channel;   ///< in the order of conversion
  std::int64_t scan_interval_ns;     ///< from the begin of a scan to that of the next
  std::int64_t convert_interval_ns;  ///< from channel to channel; 0: all at the same time
};

/// How a call went. Only kOk is good; none of them waits for more than the board's own time.
enum class DaqResult : std::uint8_t {
  kOk,
  kNothing,  ///< no sample waits to be read
  kStopped,  ///< the scan has ended by itself, and all samples are read
  kOverrun,  ///< the same, because the buffer was full or the board reports an error
  kFailed,   ///< the board, or its driver, refuses
  kGone,     ///< there is no board any more
};

/// One DAQ board with its clock: a driver never asks for the time elsewhere, so that a test can
/// give it. Thread: one. Calls that return DaqResult or nothing do not allocate and do not throw.
class DaqBoard {
 public:
  virtual ~DaqBoard() = default;

  virtual const char* device() const noexcept = 0;

  /// CLOCK_MONOTONIC, or the test's time.
  virtual std::int64_t now_ns() const noexcept = 0;

  /// @throws HalError if there is no board, or we may not use it
  virtual DaqIdentity Open() = 0;

  /// Ask and set up, start-up only. `subdevice` may be any number.
  virtual DaqSubdevice Describe(int subdevice) = 0;
  /// In volts, by index; a range that is none in volts is empty (0 .. 0).
  virtual std::vector<DaqRange> Ranges(int subdevice, int channel) = 0;
  /// From now on nobody else can use the subdevice. False if somebody has it.
  virtual bool Lock(int subdevice) = 0;
  /// Makes a digital channel an input and reads that back. False if it is none.
  virtual bool SetInput(int subdevice, int channel) = 0;
  /// Sets up a scan for StartScan. Returns it as the board will make it: its clock has steps.
  /// @throws HalError if it cannot be made at all
  virtual DaqScan SetScan(const DaqScan& scan) = 0;

  [[nodiscard]] virtual DaqResult StartScan() noexcept = 0;
  /// Ends the scan, if one runs; what was not read is dropped.
  virtual void StopScan() noexcept = 0;
  /// Copies the oldest samples that are there, at most as many as `samples` holds.
  [[nodiscard]] virtual DaqResult ReadScan(std::span<std::uint32_t> samples,
                                           std::size_t* count) noexcept = 0;
  /// Returns at `instant_ns`, or as soon as there may be samples to read.
  virtual void WaitUntil(std::int64_t instant_ns) noexcept = 0;

  /// One channel, by one instruction; an output gives what was written to it last.
  [[nodiscard]] virtual DaqResult Read(const DaqChannel& channel,
                                       std::uint32_t* value) noexcept = 0;
  [[nodiscard]] virtual DaqResult Write(const DaqChannel& channel,
                                        std::uint32_t value) noexcept = 0;
  /// Channels 0 to 31 of a digital subdevice, by one instruction.
  [[nodiscard]] virtual DaqResult ReadBits(int subdevice, std::uint32_t* bits) noexcept = 0;

  virtual void Close() noexcept = 0;
};

}  // namespace flexarm
