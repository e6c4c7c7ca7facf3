#pragma once

#include <linux/can.h>

#include <cstdint>
#include <string>
#include <vector>

#include "hal/bus_clocks.h"
#include "hal/canopen/arrival_clock.h"
#include "hal/canopen/can_bus.h"

namespace flexarm {

/// A CAN interface of the kernel (SocketCAN), hardware or virtual.
///
/// Receives only the requested identifiers, as data frames with 11 bits, and error frames of the
/// controller's state. Frames carry the instant of their arrival, from the kernel's time stamp, and
/// no step of the time of day changes it (ArrivalClock). Send never waits: the
/// socket holds a few frames, the interface's queue at most kMostQueued. The system configures the
/// interface (bit rate, up). Open rejects it if its queue is longer, its bit rate differs, or the
/// kernel would leave bus-off automatically (restart-ms): a drive must not come back while armed.
class SocketCanBus : public CanBus {
 public:
  static constexpr std::uint32_t kMostQueued = 16;  ///< frames; Linux gives a CAN interface 10

  SocketCanBus(std::string interface, BusClocks clocks);
  ~SocketCanBus() override;
  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  const char* interface() const noexcept override { return interface_.c_str(); }
  std::int64_t now_ns() const noexcept override { return clocks_.monotonic_ns(); }
  void Open(std::span<const std::uint32_t> ids, int bitrate_bps) override;
  [[nodiscard]] SendResult Send(const CanFrame& frame) noexcept override;
  bool Receive(ReceivedFrame* received) noexcept override;
  void WaitUntil(std::int64_t instant_ns) noexcept override;
  CanState state() noexcept override;
  bool unsent() noexcept override;
  bool Restart() noexcept override;
  void Close() noexcept override;
  const CanCounts& counts() const noexcept override { return counts_; }

 private:
  void CheckLink();
  void Configure(std::span<const std::uint32_t> ids);
  bool Join() noexcept;
  void TakeErrorFrame(std::uint32_t id, const std::uint8_t* data) noexcept;

  std::string interface_;
  BusClocks clocks_;
  int fd_ = -1;
  int index_ = 0;  // of the interface
  std::vector<can_filter> filters_;
  std::uint32_t bitrate_bps_ = 0;
  bool gone_ = false;  // the interface was removed, e.g. an adapter was unplugged
  CanState state_ = CanState::kDown;
  ArrivalClock arrivals_;
  CanCounts counts_;
};

}  // namespace flexarm
