#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/bus_device.h"

namespace flexarm {

/// Kind of a subdevice of a board.
enum class DaqKind : std::uint8_t {
  kAnalogInput,
  kAnalogOutput,
  kDigital,
  kCounter,
  kOther,
  kNone,  ///< the board has no subdevice with that number
};

/// Identity of a board, and properties of one of its subdevices.
struct DaqIdentity {
  std::string driver;
  std::string board;
};
struct DaqSubdevice {
  DaqKind kind;
  int channels;
  int bits;                    ///< values are 0 .. 2^bits - 1; 0: some other range
  bool streams;                ///< can scan by its own clock
  std::size_t buffer_samples;  ///< of the driver; 0 without streaming
};

/// An input or output range.
struct DaqRange {
  double lowest_v;
  double highest_v;
};

/// Reference of a voltage measurement; the value is comedi's AREF.
enum class DaqReference : std::uint8_t { kGround = 0, kCommon = 1, kDifferential = 2 };

/// One channel, with range and reference.
struct DaqChannel {
  int subdevice;
  int channel;
  int range;  ///< index of DaqBoard::Ranges
  DaqReference reference;
};

/// A scan of several inputs of one subdevice, repeated by the board's clock.
struct DaqScan {
  std::vector<DaqChannel> channel;   ///< in the order of conversion
  std::int64_t scan_interval_ns;     ///< from the start of a scan to the start of the next
  std::int64_t convert_interval_ns;  ///< from channel to channel; 0: all at the same time
};

/// Result of a call. Only kOk is success; no call waits for more than the board's own time.
enum class DaqResult : std::uint8_t {
  kOk,
  kNothing,  ///< no sample is available
  kStopped,  ///< the board has ended the scan, and all samples are read
  kOverrun,  ///< the same, because of a full buffer or an error of the board
  kFailed,   ///< the board or its driver rejects the call
  kGone,     ///< the board is gone
};

/// One DAQ board with its clock: a driver takes the time from here only, so that a test can set it.
/// Thread: one. Calls that return DaqResult or nothing do not allocate and do not throw.
class DaqBoard {
 public:
  virtual ~DaqBoard() = default;

  virtual const char* device() const noexcept = 0;

  /// CLOCK_MONOTONIC, or the test's time.
  virtual std::int64_t now_ns() const noexcept = 0;

  /// @throws HalError if there is no board, or access is denied
  virtual DaqIdentity Open() = 0;

  /// Query and configuration, start-up only. `subdevice` may be any number.
  virtual DaqSubdevice Describe(int subdevice) = 0;
  /// In volts, by index; a range in another unit is empty (0 .. 0).
  virtual std::vector<DaqRange> Ranges(int subdevice, int channel) = 0;
  /// Locks the subdevice for this process. False if another one has locked it.
  virtual bool Lock(int subdevice) = 0;
  /// Makes a digital channel an input and reads that back. False if it is not.
  virtual bool SetInput(int subdevice, int channel) = 0;
  /// Configures a scan for StartScan. Returns the scan with the timing that the board's clock
  /// allows.
  /// @throws HalError if no such scan is possible
  virtual DaqScan SetScan(const DaqScan& scan) = 0;

  [[nodiscard]] virtual DaqResult StartScan() noexcept = 0;
  /// Ends the scan, if one is running; samples that were not read are dropped.
  virtual void StopScan() noexcept = 0;
  /// Copies the oldest available samples, at most as many as `samples` holds.
  [[nodiscard]] virtual DaqResult ReadScan(std::span<std::uint32_t> samples,
                                           std::size_t* count) noexcept = 0;
  /// Returns at `instant_ns`, or earlier if samples may be available.
  virtual void WaitUntil(std::int64_t instant_ns) noexcept = 0;

  /// One channel, by one instruction; an output returns the value written last.
  [[nodiscard]] virtual DaqResult Read(const DaqChannel& channel,
                                       std::uint32_t* value) noexcept = 0;
  [[nodiscard]] virtual DaqResult Write(const DaqChannel& channel,
                                        std::uint32_t value) noexcept = 0;
  /// Channels 0 to 31 of a digital subdevice, by one instruction.
  [[nodiscard]] virtual DaqResult ReadBits(int subdevice, std::uint32_t* bits) noexcept = 0;

  virtual void Close() noexcept = 0;
};

}  // namespace flexarm
