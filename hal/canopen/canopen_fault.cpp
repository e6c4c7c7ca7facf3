#include "hal/canopen/canopen_fault.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace flexarm {
namespace {

const CanopenNodeConfig* NodeOf(const CanopenConfig& config, int node_id) noexcept {
  for (const CanopenNodeConfig& node : config.node) {
    if (node.node_id == node_id) return &node;
  }
  return nullptr;
}

const char* ToString(CanopenFaultKind kind) {
  switch (kind) {
    case CanopenFaultKind::kNone:
      return "no fault";
    case CanopenFaultKind::kEmergency:
      return "emergency message";
    case CanopenFaultKind::kHeartbeatLost:
      return "heartbeat lost";
    case CanopenFaultKind::kNotOperational:
      return "left the operational state, NMT state";
    case CanopenFaultKind::kSilent:
      return "does not answer SYNC";
    case CanopenFaultKind::kDriveFault:
      return "drive in fault, statusword";
    case CanopenFaultKind::kLeftOperation:
      return "has switched its torque off, statusword";
    case CanopenFaultKind::kNotEnabled:
      return "does not enable its torque, statusword";
    case CanopenFaultKind::kNotDisabled:
      return "does not switch its torque off, statusword";
    case CanopenFaultKind::kSecondMaster:
      return "another node sends SYNC";
    case CanopenFaultKind::kTransmitStuck:
      return "frames are not sent, no node acknowledges";
    case CanopenFaultKind::kBusOff:
      return "the CAN controller has left the bus (bus-off)";
    case CanopenFaultKind::kInterfaceDown:
      return "the interface is down";
    case CanopenFaultKind::kMalformed:
      return "sends a malformed PDO";
    case CanopenFaultKind::kSetupRefused:
      return "does not match the config, object";
    case CanopenFaultKind::kSetupSilent:
      return "does not answer during its configuration, object";
    case CanopenFaultKind::kNoSupply:
      return "is switched on but gets no supply, emergency message";
    case CanopenFaultKind::kSupplyOff:
      return "has no supply while the relay is open, emergency message";
  }
  return "?";
}

}  // namespace

BusStatus StatusOf(const CanopenConfig& config, const CanopenFault& fault) noexcept {
  switch (fault.kind) {
    case CanopenFaultKind::kNone:
      return BusStatus::kTimeout;
    case CanopenFaultKind::kBusOff:
      return BusStatus::kBusOff;
    case CanopenFaultKind::kTransmitStuck:
    case CanopenFaultKind::kInterfaceDown:
      return BusStatus::kDisconnected;
    case CanopenFaultKind::kSetupSilent:
      return BusStatus::kTimeout;
    case CanopenFaultKind::kSecondMaster:
    case CanopenFaultKind::kMalformed:
    case CanopenFaultKind::kSetupRefused:
      return BusStatus::kMalformed;
    case CanopenFaultKind::kEmergency:
    case CanopenFaultKind::kHeartbeatLost:
    case CanopenFaultKind::kNotOperational:
    case CanopenFaultKind::kSilent:
    case CanopenFaultKind::kDriveFault:
    case CanopenFaultKind::kLeftOperation:
    case CanopenFaultKind::kNotEnabled:
    case CanopenFaultKind::kNotDisabled:
    case CanopenFaultKind::kNoSupply:
    case CanopenFaultKind::kSupplyOff:
      break;
  }
  const CanopenNodeConfig* node = NodeOf(config, fault.node_id);
  return node != nullptr && IsDrive(node->role) ? BusStatus::kDriveFault : BusStatus::kDisconnected;
}

bool NeedsAcknowledgement(const CanopenConfig& config, const CanopenFault& fault) noexcept {
  using enum CanopenFaultKind;
  constexpr std::array kOfDrive = {kEmergency,  kDriveFault,  kLeftOperation,
                                   kNotEnabled, kNotDisabled, kNoSupply};
  if (std::find(kOfDrive.begin(), kOfDrive.end(), fault.kind) == kOfDrive.end()) return false;
  const CanopenNodeConfig* node = NodeOf(config, fault.node_id);
  return node != nullptr && IsDrive(node->role);
}

BusFault Packed(const CanopenFault& fault) noexcept {
  return {.kind = static_cast<std::uint8_t>(fault.kind),
          .node = static_cast<std::uint8_t>(fault.node_id),
          .code = fault.code};
}

CanopenFault Unpacked(const BusFault& fault) noexcept {
  return {
      .kind = static_cast<CanopenFaultKind>(fault.kind), .node_id = fault.node, .code = fault.code};
}

std::string CanopenFaultText(const CanopenConfig& config, const CanopenFault& fault) {
  std::string text = config.interface + ": ";
  if (const CanopenNodeConfig* node = NodeOf(config, fault.node_id)) {
    text += "node " + std::to_string(node->node_id) + " (" + ToString(node->role) + "): ";
  }
  text += ToString(fault.kind);
  if (fault.code == 0) return text;
  std::array<char, 4> hex{};
  const auto [end, error] = std::to_chars(hex.data(), hex.data() + hex.size(), fault.code, 16);
  return text + " 0x" + std::string(hex.data(), end);
}

}  // namespace flexarm
