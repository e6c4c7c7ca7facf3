#pragma once

#include <cstdint>
#include <memory>

#include "hal/canopen/can_bus.h"

namespace flexarm {

/// A CAN bus that knows whether all of its own frames have been on the wire.
///
/// The kernel no longer counts a frame that the driver has accepted, but a controller or a USB
/// adapter holds 8 to 32 of them, for as long as no node acknowledges. The echo of a frame comes
/// when it has been sent, so unsent() is true until every frame sent since Open or Restart has had
/// its echo. A driver without an echo of its own (CanLink::echo) is the exception: the kernel makes
/// the echo when it hands the frame over. An echo that is lost leaves unsent() true until Restart:
/// the safe side.
///
/// Real-time: adds no wait and no allocation. Thread: one.
class ConfirmedBus final : public CanBus {
 public:
  explicit ConfirmedBus(std::unique_ptr<CanBus> bus) : bus_(std::move(bus)) {}

  const char* interface() const noexcept override { return bus_->interface(); }
  std::int64_t now_ns() const noexcept override { return bus_->now_ns(); }
  /// @param ids  also those of all frames that are sent: their echoes are needed
  void Open(std::span<const std::uint32_t> ids, int bitrate_bps) override;
  [[nodiscard]] SendResult Send(const CanFrame& frame) noexcept override;
  bool Receive(ReceivedFrame* received) noexcept override;
  void WaitUntil(std::int64_t instant_ns) noexcept override { bus_->WaitUntil(instant_ns); }
  CanState state() noexcept override { return bus_->state(); }
  bool unsent() noexcept override { return unconfirmed_ > 0 || bus_->unsent(); }
  bool Restart() noexcept override;
  void Close() noexcept override { bus_->Close(); }
  const CanCounts& counts() const noexcept override { return bus_->counts(); }

 private:
  std::unique_ptr<CanBus> bus_;
  int unconfirmed_ = 0;                // frames without their echo
  std::int64_t since_ns_ = INT64_MIN;  // Open or Restart: older echoes are of dropped frames
};

}  // namespace flexarm
