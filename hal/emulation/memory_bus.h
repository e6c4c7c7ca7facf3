#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "hal/canopen/arrival_clock.h"
#include "hal/canopen/can_bus.h"

namespace flexarm {

class MemoryBus;

/// A CAN bus in memory, with its own time: frames take the time that they take on a wire, the
/// lowest identifier is sent first, and a test may lose, change, delay or repeat each for its
/// receivers; its sender has the echo. It advances only within AdvanceTo, or while an end waits.
/// Received frames have a stamp in the time of day, as those of the kernel. One thread. Allocates
/// during set-up only.
class MemoryWire {
 public:
  /// Manipulation of a frame by a test, which may also change the frame itself.
  struct Fate {
    int copies = 1;              ///< 0: lost after its acknowledgement
    std::int64_t delay_ns = 0;   ///< in addition to the wire's delay
    std::int64_t waited_ns = 0;  ///< time in the receiver's queue: its time stamp is older by that
  };

  explicit MemoryWire(int bitrate_bps) : bitrate_bps_(bitrate_bps) {}

  std::int64_t now_ns() const noexcept { return now_ns_; }
  /// Frames that have been on the wire.
  std::uint64_t frames() const noexcept { return frames_; }
  void AdvanceTo(std::int64_t instant_ns) noexcept;

  /// Called every 100 us and after each frame, to run a node; it must not wait.
  void AddRunner(std::function<void()> run) { runners_.push_back(std::move(run)); }
  void SetTamper(std::function<Fate(CanFrame*)> tamper) { tamper_ = std::move(tamper); }
  /// While set no node acknowledges: sent frames wait in the transmit queues.
  void SetStalled(bool stalled) noexcept { stalled_ = stalled; }
  /// The time of day is stepped by `by_ns` at `at_ns`: ascending. Set-up only.
  void AddClockStep(std::int64_t at_ns, std::int64_t by_ns) { steps_.push_back({at_ns, by_ns}); }

 private:
  friend class MemoryBus;
  static constexpr std::int64_t kGrid_ns = 100'000;

  struct Delivery {
    CanFrame frame;
    std::int64_t at_ns;
    std::int64_t waited_ns;
    const MemoryBus* from;
  };

  struct ClockStep {
    std::int64_t at_ns;
    std::int64_t by_ns;
  };

  /// The time of day at `instant_ns`.
  std::int64_t RealtimeAt(std::int64_t instant_ns) const noexcept;
  /// Advances to the next event, at most to `limit_ns`.
  void StepTo(std::int64_t limit_ns) noexcept;
  void BeginFrame() noexcept;
  void EndFrame() noexcept;
  void Deliver(const Delivery& delivery) noexcept;

  int bitrate_bps_;
  std::int64_t now_ns_ = 0;
  std::uint64_t frames_ = 0;
  bool stalled_ = false;
  bool busy_ = false;
  Delivery on_wire_{};
  std::array<Delivery, 64> late_{};
  std::size_t late_count_ = 0;
  std::vector<MemoryBus*> ends_;
  std::vector<std::function<void()>> runners_;
  std::function<Fate(CanFrame*)> tamper_;
  std::vector<ClockStep> steps_;
};

/// One end of a MemoryWire. It is connected from Open to Close; frames queued at Close are still
/// sent, as by a kernel.
class MemoryBus : public CanBus {
 public:
  static constexpr std::size_t kTransmitQueue = 16;  ///< frames, as a CAN interface has about ten
  static constexpr std::size_t kReceiveQueue = 512;

  explicit MemoryBus(MemoryWire* wire, const char* interface = "memory");
  ~MemoryBus() override;
  MemoryBus(const MemoryBus&) = delete;
  MemoryBus& operator=(const MemoryBus&) = delete;

  const char* interface() const noexcept override { return interface_; }
  std::int64_t now_ns() const noexcept override { return wire_->now_ns(); }
  void Open(std::span<const std::uint32_t> ids, int bitrate_bps) override;
  [[nodiscard]] SendResult Send(const CanFrame& frame) noexcept override;
  bool Receive(ReceivedFrame* received) noexcept override;
  void WaitUntil(std::int64_t instant_ns) noexcept override;
  CanState state() noexcept override { return state_; }
  /// As of the kernel: without what the controller holds.
  bool unsent() noexcept override { return sending_count_ > controller_frames_; }
  bool Restart() noexcept override;
  void Close() noexcept override { open_ = false; }
  const CanCounts& counts() const noexcept override { return counts_; }

  /// For a test: receives every frame.
  void OpenForAll();
  /// The controller leaves the bus: no frame is sent or received until Restart.
  void SetBusOff() noexcept { state_ = CanState::kBusOff; }
  /// Sends beyond this number of waiting frames are rejected; at most kTransmitQueue.
  void SetTransmitQueue(std::size_t frames) noexcept { capacity_ = frames; }
  /// The first `frames` of those that wait are in the controller: the kernel does not count them.
  void SetControllerQueue(std::size_t frames) noexcept { controller_frames_ = frames; }
  /// Whether Restart works: false as long as the cause of a bus-off lasts.
  void SetRestartable(bool restartable) noexcept { restartable_ = restartable; }

 private:
  friend class MemoryWire;
  /// `received.at_ns` is true; it is kept as a stamp in the time of day.
  void Accept(ReceivedFrame received) noexcept;
  void PopSent() noexcept;

  MemoryWire* wire_;
  const char* interface_;
  bool open_ = false;
  bool all_ = false;
  bool restartable_ = true;
  CanState state_ = CanState::kActive;
  std::vector<std::uint32_t> ids_;
  std::array<CanFrame, kTransmitQueue> sending_{};
  std::size_t sending_count_ = 0;
  std::size_t capacity_ = kTransmitQueue;
  std::size_t controller_frames_ = 0;
  std::array<ReceivedFrame, kReceiveQueue> received_{};
  std::size_t first_ = 0;
  std::size_t received_count_ = 0;
  ArrivalClock arrivals_;
  CanCounts counts_;
};

}  // namespace flexarm
