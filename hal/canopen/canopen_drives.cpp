#include <algorithm>
#include <cmath>

#include "hal/canopen/canopen_device.h"

// CanopenDevice: commands to the drives, and what they make of them.

namespace flexarm {
namespace {

// A drive charges its intermediate circuit or releases a brake: a second at 50 Hz.
constexpr int kFramesToEnable = 50;
constexpr int kFramesToDisable = 5;
// A drive may send its emergency after the statusword of the same fault.
constexpr int kFramesToExplain = 2;

bool InFault(DriveState state) noexcept {
  return state == DriveState::kFault || state == DriveState::kFaultReactionActive;
}

}  // namespace

CanFrame CanopenDevice::CommandFor(const Node& node, DriveWish wish,
                                   const BusCommand& command) const noexcept {
  // Its supply was missing, and is back: each second command is a rising edge of the reset.
  const bool resets = wish == DriveWish::kOn && Excused(node) && node.waiting % 2 == 0;
  DriveCommand drive{
      .controlword = ControlwordFor(node.state, resets ? DriveWish::kResetFault : wish),
      .torque_per_mille = 0};
  const std::size_t joint = node.config->role == CanopenRole::kDrive1 ? 0 : 1;
  const double torque_nm = command.torque_nm[joint];
  const bool expired = bus_.now_ns() > command.expires_ns;
  if (wish == DriveWish::kOn && node.state == DriveState::kOperationEnabled && !expired &&
      std::isfinite(torque_nm)) {
    const double most = node.config->torque_range_per_mille();
    const double asked = node.config->sign * torque_nm / node.config->torque_per_mille_nm;
    drive.torque_per_mille = static_cast<std::int16_t>(std::lround(std::clamp(asked, -most, most)));
  }
  return EncodeDriveCommand(node.config->node_id, drive);
}

bool CanopenDevice::Excused(const Node& node) noexcept {
  return InFault(node.state) && node.no_supply != 0 && !node.was_enabled;
}

void CanopenDevice::FollowFault(Node* node) noexcept {
  if (!InFault(node->state)) {
    node->unexplained = 0;
    if (++node->without_fault > kFramesToExplain) node->no_supply = 0;
    return;
  }
  node->without_fault = 0;
  if (Excused(*node)) return;
  const int patience = node->was_enabled ? 0 : kFramesToExplain;
  if (++node->unexplained > patience) {
    Latch(CanopenFaultKind::kDriveFault, node, node->statusword);
  }
}

void CanopenDevice::FollowDrive(DriveWish wish, Node* node) noexcept {
  using enum DriveState;
  node->state = DecodeDriveState(node->statusword);
  const bool operating = node->state == kOperationEnabled;
  if (wish != DriveWish::kResetFault) FollowFault(node);
  const bool follows = (wish == DriveWish::kOn) == operating;
  node->waiting = follows ? 0 : node->waiting + 1;
  if (wish == DriveWish::kOn) {
    if (node->was_enabled && !operating) {
      Latch(CanopenFaultKind::kLeftOperation, node, node->statusword);
    } else if (node->waiting > kFramesToEnable) {
      const bool no_supply = Excused(*node);
      Latch(no_supply ? CanopenFaultKind::kNoSupply : CanopenFaultKind::kNotEnabled, node,
            no_supply ? node->no_supply : node->statusword);
    }
    node->was_enabled = node->was_enabled || operating;
  } else if (node->waiting > kFramesToDisable) {
    Latch(CanopenFaultKind::kNotDisabled, node, node->statusword);
  }
}

void CanopenDevice::MarkOff() noexcept {
  for (Node& node : nodes()) node.was_enabled = false;
}

BusStatus CanopenDevice::SwitchOff() noexcept {
  if (!open_ || configuring_) return BusStatus::kOk;  // the drives are off
  MarkOff();
  // Also while frames of the last exchange wait: these come after them, and carry no torque.
  return SendOff() ? BusStatus::kOk : Stuck();
}

bool CanopenDevice::SendOff() noexcept {
  const BusCommand off{.torque_nm = {}, .enabled = false};
  bool sent = true;
  for (const Node& node : nodes()) {
    if (!IsDrive(node.config->role)) continue;
    sent = bus_.Send(CommandFor(node, DriveWish::kOff, off)) == SendResult::kSent && sent;
  }
  return bus_.Send(EncodeSync()) == SendResult::kSent && sent;
}

BusStatus CanopenDevice::Acknowledge() noexcept {
  const CanopenFault before = fault_;
  fault_ = {};
  const bool even = acknowledged_++ % 2 == 0;  // the reset acts on its rising edge: off in between
  const BusStatus status =
      Cycle(even ? DriveWish::kResetFault : DriveWish::kOff, {.torque_nm = {}, .enabled = false});
  bool gone = status == BusStatus::kOk && fault_.kind == CanopenFaultKind::kNone;
  // A drive whose supply fell away in operation cannot leave that fault before the relay closes.
  for (const Node& node : nodes()) {
    if (!IsDrive(node.config->role)) continue;
    gone = gone && node.state != DriveState::kOperationEnabled &&
           (!InFault(node.state) || Excused(node));
  }
  if (gone) {
    acknowledged_ = 0;
  } else if (fault_.kind != CanopenFaultKind::kEmergency) {
    fault_ = before;  // it says more than the statusword; a new emergency says more than it
  }
  return status;
}

BusFault CanopenDevice::notice() const noexcept {
  for (const Node& node : nodes_) {
    if (node.config == nullptr || node.no_supply == 0) continue;
    return Packed({CanopenFaultKind::kSupplyOff, node.config->node_id, node.no_supply});
  }
  return {};
}

const CanopenDevice::Node* CanopenDevice::Drive(int joint) const noexcept {
  const CanopenRole role = joint == 0 ? CanopenRole::kDrive1 : CanopenRole::kDrive2;
  for (const Node& node : nodes_) {
    if (node.config != nullptr && node.config->role == role) return &node;
  }
  return nullptr;
}

std::uint32_t CanopenDevice::drives_on() const noexcept {
  std::uint32_t on = 0;
  for (int joint = 0; joint < 2; ++joint) {
    if (drive_state(joint) == DriveState::kOperationEnabled) on |= 1U << joint;
  }
  return on;
}

DriveVoltage CanopenDevice::voltage() const noexcept {
  DriveVoltage voltage;
  for (int joint = 0; joint < 2; ++joint) {
    const Node* drive = Drive(joint);
    if (drive == nullptr || !drive->answered) continue;
    std::uint8_t& set = VoltageEnabled(drive->statusword) ? voltage.on : voltage.off;
    set = static_cast<std::uint8_t>(set | 1U << joint);
  }
  return voltage;
}

DriveState CanopenDevice::drive_state(int joint) const noexcept {
  const Node* drive = Drive(joint);
  return drive == nullptr ? DriveState::kUnknown : drive->state;
}

double CanopenDevice::drive_torque_nm(int joint) const noexcept {
  const Node* drive = Drive(joint);
  if (drive == nullptr) return 0.0;
  return drive->config->sign * drive->config->torque_per_mille_nm * drive->torque_per_mille;
}

}  // namespace flexarm
