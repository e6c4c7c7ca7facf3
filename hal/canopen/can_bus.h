#pragma once

#include <cstdint>
#include <span>

#include "hal/canopen/can_frame.h"

namespace flexarm {

/// What became of a frame that was to be sent. Only kSent is good; none of them waits.
enum class SendResult : std::uint8_t {
  kSent,       ///< handed to the transmit queue
  kQueueFull,  ///< ENOBUFS, EAGAIN: nobody acknowledges, or the bus is too busy
  kFailed,     ///< the interface is down or gone
};

/// State of the CAN controller.
enum class CanState : std::uint8_t { kActive, kPassive, kBusOff, kDown };

/// Counts since Open, for the log.
struct CanCounts {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t queue_full = 0;    ///< sends refused
  std::uint64_t error_frames = 0;  ///< reports of the controller, or of the kernel
};

/// One end of a CAN bus, with its clock: a driver never asks for the time elsewhere, so that a test
/// can give it. Thread: one. Nothing waits but WaitUntil; Open and Restart may take milliseconds.
class CanBus {
 public:
  virtual ~CanBus() = default;

  virtual const char* interface() const noexcept = 0;

  /// CLOCK_MONOTONIC, or the test's time.
  virtual std::int64_t now_ns() const noexcept = 0;

  /// Joins the bus, at `bitrate_bps` if it has one. From now on frames with one of `ids` are
  /// received and no others; the own ones among them too, as their echo.
  /// @throws HalError
  virtual void Open(std::span<const std::uint32_t> ids, int bitrate_bps) = 0;

  [[nodiscard]] virtual SendResult Send(const CanFrame& frame) noexcept = 0;

  /// The oldest frame that has come, if there is one.
  virtual bool Receive(ReceivedFrame* received) noexcept = 0;

  /// Returns at `instant_ns`, or as soon as there may be a frame to receive.
  virtual void WaitUntil(std::int64_t instant_ns) noexcept = 0;

  /// As the last error frame and the interface say.
  virtual CanState state() noexcept = 0;

  /// Frames of this end still wait to go out.
  virtual bool unsent() noexcept = 0;

  /// Throws away every frame that waits to be sent, and leaves bus-off. Only while disarmed.
  /// False if that is not possible (yet).
  virtual bool Restart() noexcept = 0;

  virtual void Close() noexcept = 0;

  virtual const CanCounts& counts() const noexcept = 0;
};

}  // namespace flexarm
