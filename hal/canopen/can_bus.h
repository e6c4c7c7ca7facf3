#pragma once

#include <cstdint>
#include <span>

#include "hal/canopen/can_frame.h"

namespace flexarm {

/// Result of sending a frame. Only kSent is success; no call waits.
enum class SendResult : std::uint8_t {
  kSent,       ///< handed to the transmit queue
  kQueueFull,  ///< ENOBUFS, EAGAIN: no node acknowledges, or the bus is overloaded
  kFailed,     ///< the interface is down or was removed
};

/// State of the CAN controller.
enum class CanState : std::uint8_t { kActive, kPassive, kBusOff, kDown };

/// Counts since Open, for the log.
struct CanCounts {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t queue_full = 0;    ///< rejected sends
  std::uint64_t error_frames = 0;  ///< error reports of the controller or of the kernel
};

/// One end of a CAN bus, with its clock: a driver takes the time from here only, so that a test can
/// set it. Thread: one. Only WaitUntil waits; Open and Restart may take milliseconds.
class CanBus {
 public:
  virtual ~CanBus() = default;

  virtual const char* interface() const noexcept = 0;

  /// CLOCK_MONOTONIC, or the test's time.
  virtual std::int64_t now_ns() const noexcept = 0;

  /// Joins the bus, at `bitrate_bps` if it has a bit rate. Then only frames with one of `ids` are
  /// received, including the echo of the frames sent from this end.
  /// @throws HalError
  virtual void Open(std::span<const std::uint32_t> ids, int bitrate_bps) = 0;

  [[nodiscard]] virtual SendResult Send(const CanFrame& frame) noexcept = 0;

  /// Takes the oldest received frame; false if there is none.
  virtual bool Receive(ReceivedFrame* received) noexcept = 0;

  /// Returns at `instant_ns`, or earlier if a frame may have been received.
  virtual void WaitUntil(std::int64_t instant_ns) noexcept = 0;

  /// State from the last error frame and the interface.
  virtual CanState state() noexcept = 0;

  /// True while frames of this end wait in the kernel. The controller may hold more: ConfirmedBus.
  virtual bool unsent() noexcept = 0;

  /// Drops all frames that wait for transmission, and leaves bus-off. Only while disarmed.
  /// False if that is not possible (yet).
  virtual bool Restart() noexcept = 0;

  virtual void Close() noexcept = 0;

  virtual const CanCounts& counts() const noexcept = 0;
};

}  // namespace flexarm
