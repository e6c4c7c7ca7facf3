#include <algorithm>

#include "hal/canopen/canopen_device.h"

// CanopenDevice: handling of received frames.

namespace flexarm {
namespace {

constexpr std::uint32_t kFunction = 0x780, kNodeId = 0x07F;

}  // namespace

void CanopenDevice::Handle(const ReceivedFrame& received) noexcept {
  if (received.frame.id == kCobSync) return HandleSync(received);
  Node* node = Find(static_cast<int>(received.frame.id & kNodeId));
  if (node == nullptr || received.own) return;
  switch (received.frame.id & kFunction) {
    case kCobTpdo:
      return HandleFeedback(received, node);
    case kCobEmergency:
      return HandleEmergency(received, node);
    case kCobHeartbeat:
      return HandleHeartbeat(received, node);
    default:
      return;  // a late SDO answer
  }
}

void CanopenDevice::HandleSync(const ReceivedFrame& received) noexcept {
  if (!received.own) return Latch(CanopenFaultKind::kSecondMaster, nullptr, 0);
  if (collecting_ && received.at_ns >= sync_sent_ns_) sampled_ns_ = received.at_ns;
}

void CanopenDevice::HandleFeedback(const ReceivedFrame& received, Node* node) noexcept {
  if (!collecting_ || received.at_ns < sync_sent_ns_) {
    ++counts_.stale;
    return;
  }
  if (node->answered) {
    ++counts_.duplicated;
    // After a miss the first may be the late answer to the previous SYNC; a node sends in order.
    if (node->missed == 0) return;
  }
  const bool answered_before = node->answered;
  node->answered = false;
  if (IsDrive(node->config->role)) {
    if (const auto feedback = DecodeDriveFeedback(received.frame)) {
      node->statusword = feedback->statusword;
      node->torque_per_mille = feedback->torque_per_mille;
      node->counts = static_cast<std::uint32_t>(feedback->position_counts);
      node->answered = true;
    }
  } else if (const auto position = DecodeEncoderPosition(received.frame)) {
    node->counts = *position;
    node->answered = true;
  }
  if (node->answered) return;
  node->answered = answered_before;
  ++counts_.malformed;
  malformed_ = node;
}

void CanopenDevice::HandleEmergency(const ReceivedFrame& received, Node* node) noexcept {
  const auto emergency = DecodeEmergency(received.frame);
  if (!emergency) {
    ++counts_.malformed;
  } else if (emergency->code != 0) {  // 0: the error is cleared; the statusword shows it too
    TakeEmergency(emergency->code, node);
  }
}

void CanopenDevice::TakeEmergency(std::uint16_t code, Node* node) noexcept {
  const bool of_supply = IsDrive(node->config->role) && SupplyEmergency(code);
  if (of_supply) {
    node->no_supply = code;
    node->without_fault = 0;
  }
  if (!of_supply || node->was_enabled) Latch(CanopenFaultKind::kEmergency, node, code);
}

void CanopenDevice::HandleHeartbeat(const ReceivedFrame& received, Node* node) noexcept {
  const auto state = DecodeHeartbeat(received.frame);
  if (!state) {
    ++counts_.malformed;
    return;
  }
  if (*state == NmtState::kBooting) LoseCount(*node);  // it lost power, or was reset
  node->heartbeat_ns = std::max(node->heartbeat_ns, received.at_ns);
  if (*state != NmtState::kOperational) {
    Latch(CanopenFaultKind::kNotOperational, node, static_cast<unsigned>(*state));
  }
}

}  // namespace flexarm
