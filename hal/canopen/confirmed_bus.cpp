#include "hal/canopen/confirmed_bus.h"

namespace flexarm {

void ConfirmedBus::Open(std::span<const std::uint32_t> ids, int bitrate_bps) {
  bus_->Open(ids, bitrate_bps);
  unconfirmed_ = 0;
  since_ns_ = now_ns();
}

SendResult ConfirmedBus::Send(const CanFrame& frame) noexcept {
  const SendResult result = bus_->Send(frame);
  if (result == SendResult::kSent) ++unconfirmed_;
  return result;
}

bool ConfirmedBus::Receive(ReceivedFrame* received) noexcept {
  if (!bus_->Receive(received)) return false;
  if (received->own && received->at_ns >= since_ns_ && unconfirmed_ > 0) --unconfirmed_;
  return true;
}

bool ConfirmedBus::Restart() noexcept {
  if (!bus_->Restart()) return false;
  unconfirmed_ = 0;
  since_ns_ = now_ns();
  return true;
}

}  // namespace flexarm
