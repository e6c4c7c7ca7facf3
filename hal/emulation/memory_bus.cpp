#include "hal/emulation/memory_bus.h"

#include <algorithm>

namespace flexarm {
namespace {

constexpr std::int64_t kRealtimeEpoch_ns = 1'700'000'000'000'000'000;

}  // namespace

void MemoryWire::AdvanceTo(std::int64_t instant_ns) noexcept {
  while (now_ns_ < instant_ns) StepTo(instant_ns);
}

void MemoryWire::StepTo(std::int64_t limit_ns) noexcept {
  BeginFrame();
  const std::int64_t grid_ns = (now_ns_ / kGrid_ns + 1) * kGrid_ns;
  std::int64_t next_ns = std::min(limit_ns, grid_ns);
  if (busy_) next_ns = std::min(next_ns, on_wire_.at_ns);
  for (std::size_t i = 0; i < late_count_; ++i) next_ns = std::min(next_ns, late_[i].at_ns);
  now_ns_ = std::max(now_ns_, next_ns);
  const bool on_grid = now_ns_ == grid_ns;
  bool delivered = false;
  if (busy_ && on_wire_.at_ns <= now_ns_) {
    EndFrame();
    delivered = true;
  }
  for (std::size_t i = 0; i < late_count_;) {
    if (late_[i].at_ns > now_ns_) {
      ++i;
      continue;
    }
    const Delivery due = late_[i];
    late_[i] = late_[--late_count_];
    Deliver(due);
    delivered = true;
  }
  if (!on_grid && !delivered) return;
  for (const std::function<void()>& run : runners_) run();
}

void MemoryWire::BeginFrame() noexcept {
  if (busy_ || stalled_) return;
  MemoryBus* first = nullptr;
  for (MemoryBus* end : ends_) {
    if (end->sending_count_ == 0 || end->state_ == CanState::kBusOff) continue;
    if (first == nullptr || end->sending_[0].id < first->sending_[0].id) first = end;
  }
  if (first == nullptr) return;
  const CanFrame& frame = first->sending_[0];
  on_wire_ = {frame, now_ns_ + FrameTimeNs(frame.length, bitrate_bps_), 0, first};
  busy_ = true;
}

void MemoryWire::EndFrame() noexcept {
  busy_ = false;
  ++frames_;
  for (MemoryBus* end : ends_) {
    if (end != on_wire_.from) continue;
    end->PopSent();
    end->Accept({on_wire_.frame, now_ns_, true});
  }
  Delivery delivery = on_wire_;
  const Fate fate = tamper_ ? tamper_(&delivery.frame) : Fate{};
  delivery.at_ns = now_ns_ + fate.delay_ns;
  delivery.waited_ns = fate.waited_ns;
  for (int copy = 0; copy < fate.copies; ++copy) {
    if (fate.delay_ns == 0) {
      Deliver(delivery);
    } else if (late_count_ < late_.size()) {
      late_[late_count_++] = delivery;
    }
  }
}

std::int64_t MemoryWire::RealtimeAt(std::int64_t instant_ns) const noexcept {
  std::int64_t realtime_ns = kRealtimeEpoch_ns + instant_ns;
  for (const ClockStep& step : steps_) realtime_ns += step.at_ns <= instant_ns ? step.by_ns : 0;
  return realtime_ns;
}

void MemoryWire::Deliver(const Delivery& delivery) noexcept {
  for (MemoryBus* end : ends_) {
    if (end == delivery.from) continue;
    end->Accept({delivery.frame, delivery.at_ns - delivery.waited_ns, false});
  }
}

MemoryBus::MemoryBus(MemoryWire* wire, const char* interface) : wire_(wire), interface_(interface) {
  wire_->ends_.push_back(this);
}

MemoryBus::~MemoryBus() { std::erase(wire_->ends_, this); }

void MemoryBus::Open(std::span<const std::uint32_t> ids, int /*bitrate_bps*/) {
  ids_.assign(ids.begin(), ids.end());
  all_ = false;
  open_ = true;
  counts_ = {};
  sending_count_ = received_count_ = 0;
  arrivals_.Begin(wire_->now_ns());
}

void MemoryBus::OpenForAll() {
  Open({}, 0);
  all_ = true;
}

SendResult MemoryBus::Send(const CanFrame& frame) noexcept {
  if (!open_) return SendResult::kFailed;
  if (state_ == CanState::kBusOff || sending_count_ >= capacity_) {
    ++counts_.queue_full;  // a controller in bus-off sends nothing from its queue
    return SendResult::kQueueFull;
  }
  sending_[sending_count_++] = frame;
  ++counts_.sent;
  return SendResult::kSent;
}

bool MemoryBus::Receive(ReceivedFrame* received) noexcept {
  const std::int64_t now_ns = wire_->now_ns();
  if (received_count_ == 0) {
    arrivals_.Emptied(now_ns);
    return false;
  }
  *received = received_[first_];
  arrivals_.Take({now_ns, wire_->RealtimeAt(now_ns), now_ns});
  received->at_ns = arrivals_.ArrivalOf(received->at_ns);
  first_ = (first_ + 1) % kReceiveQueue;
  --received_count_;
  ++counts_.received;
  return true;
}

void MemoryBus::WaitUntil(std::int64_t instant_ns) noexcept {
  while (received_count_ == 0 && wire_->now_ns() < instant_ns) wire_->StepTo(instant_ns);
}

bool MemoryBus::Restart() noexcept {
  if (wire_->busy_ && wire_->on_wire_.from == this) wire_->busy_ = false;
  sending_count_ = 0;
  if (!restartable_) return false;
  state_ = CanState::kActive;
  return true;
}

void MemoryBus::Accept(ReceivedFrame received) noexcept {
  if (!open_ || state_ == CanState::kBusOff || received_count_ == kReceiveQueue) return;
  if (!all_ && std::find(ids_.begin(), ids_.end(), received.frame.id) == ids_.end()) return;
  received.at_ns = wire_->RealtimeAt(received.at_ns);
  received_[(first_ + received_count_) % kReceiveQueue] = received;
  ++received_count_;
}

void MemoryBus::PopSent() noexcept {
  std::move(sending_.begin() + 1, sending_.begin() + static_cast<std::ptrdiff_t>(sending_count_),
            sending_.begin());
  --sending_count_;
}

}  // namespace flexarm
