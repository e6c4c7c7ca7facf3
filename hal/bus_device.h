#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "hal/bus_counters.h"
#include "hal/bus_fault.h"
#include "hal/count_epochs.h"
#include "hal/drive_voltage.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// A device cannot be opened or configured. what(): device, what was found, what was expected.
class HalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Result of one exchange with a bus. Anything but kOk is counted and, if it lasts, a named fault.
enum class BusStatus : std::uint8_t {
  kOk,
  kTimeout,       ///< no reply, or an incomplete one, within the time-out
  kMalformed,     ///< malformed reply: wrong id, length, unit, checksum, range
  kDisconnected,  ///< the connection to the peer is lost
  kBusOff,        ///< the CAN controller has left the bus
  kDriveFault,    ///< a drive reports a fault, or has left the operational state
};

/// Text of a status for messages: "no answer in time".
constexpr const char* ToString(BusStatus status) noexcept {
  switch (status) {
    case BusStatus::kOk:
      return "answers";
    case BusStatus::kTimeout:
      return "no answer in time";
    case BusStatus::kMalformed:
      return "malformed reply";
    case BusStatus::kDisconnected:
      return "connection lost";
    case BusStatus::kBusOff:
      return "the CAN controller has left the bus (bus-off)";
    case BusStatus::kDriveFault:
      return "a drive reports a fault";
  }
  return "?";
}

/// Command to a bus for one period. A bus without drives ignores it.
struct BusCommand {
  std::array<double, 2> torque_nm;  ///< after the gate, at the gearbox output
  bool enabled;                     ///< false: the drives must be off, for any torque
  /// CLOCK_MONOTONIC: later than this no torque is sent. Looked at just before each output.
  std::int64_t expires_ns = INT64_MAX;
  /// The operator resets: faults of the drives are acknowledged. Only while not enabled.
  bool acknowledge = false;
};

/// One bus, board or serial line. It has its own thread, because its calls may block.
///
/// Order: Open, then Exchange once a period, and SwitchOff at any time between; after a failed one
/// Reconnect, while needs_reconnect(), until it succeeds, but only while the arm is disarmed. A
/// drive in fault is no reason to reconnect: it answers, and its fault stays until an Exchange with
/// `acknowledge`. Thread: the bus's own; Open and Close when no thread runs.
class BusDevice {
 public:
  virtual ~BusDevice() = default;

  virtual const char* name() const noexcept = 0;

  /// Bit i: the drive of joint i + 1 is on this bus.
  virtual std::uint32_t drives() const noexcept { return 0; }

  /// Bit i: the drive of joint i + 1 has confirmed that it makes torque when commanded; by the last
  /// exchange. A drive that reports nothing is on while it is commanded.
  virtual std::uint32_t drives_on() const noexcept { return 0; }

  /// Voltage that its drives reported in the last exchange; counts only if that has answered.
  virtual DriveVoltage voltage() const noexcept { return {}; }

  /// Of the counters that this device reads; 0 for the others. A counter starts again when its
  /// device lost power or was reset.
  virtual CountEpochs count_epochs() const noexcept { return {}; }

  /// After a failed exchange: true if Reconnect must recover the device, false if the next Exchange
  /// can succeed.
  virtual bool needs_reconnect() const noexcept { return true; }

  /// A message of a drive that is no fault, because the power is off: FaultText gives its text.
  /// Kind 0: none. It is shown while it lasts.
  virtual BusFault notice() const noexcept { return {}; }

  /// Names of the counters, for status; at most kMostBusCounters. The same for the whole life of
  /// the device. Any thread.
  virtual std::span<const char* const> counter_names() const noexcept { return {}; }

  /// Their values. Thread: the bus's.
  virtual BusCounters counter_values() const noexcept { return {}; }

  /// The digital inputs that an exchange reads; the other levels of its frame are 0.
  virtual LineLevels lines() const noexcept { return 0; }

  /// Declared bound of one Exchange or Reconnect, for any behaviour of the peer. A test asserts it.
  virtual std::int64_t worst_case_ns() const noexcept = 0;

  /// Connects, identifies, configures and reads the configuration back. May take seconds.
  /// @throws HalError
  virtual void Open() = 0;

  /// Writes `command`, then reads. On return only this bus's readings in `part` are valid;
  /// sampled_at_ns and offsets in CLOCK_MONOTONIC. On failure no reading is valid, except with
  /// kDriveFault, no needs_reconnect() and a sampled_at_ns that is not 0: all devices have
  /// answered, the drives are off.
  [[nodiscard]] virtual BusStatus Exchange(const BusCommand& command,
                                           SensorFrame* part) noexcept = 0;

  /// Between two exchanges: switches the drives off at once, by the shortest path. Waits for no
  /// answer: the next exchange reads what the drives did. Does nothing on a bus without drives.
  [[nodiscard]] virtual BusStatus SwitchOff() noexcept { return BusStatus::kOk; }

  /// One bounded attempt to recover from a failure.
  [[nodiscard]] virtual BusStatus Reconnect() noexcept = 0;

  /// Fault that made the last Exchange or Reconnect return `status`, not kOk. Thread: the bus's.
  virtual BusFault FaultOf(BusStatus status) const noexcept {
    return {.kind = static_cast<std::uint8_t>(status), .node = 0, .code = 0};
  }

  /// Text of a fault of FaultOf, with the names of device and node. Any thread; not real-time.
  virtual std::string FaultText(const BusFault& fault) const {
    return std::string(name()) + ": " + ToString(static_cast<BusStatus>(fault.kind));
  }

  /// Switches the torque off by the shortest path, then releases the device.
  virtual void Close() noexcept = 0;
};

}  // namespace flexarm
