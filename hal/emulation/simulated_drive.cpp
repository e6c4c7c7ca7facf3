#include <algorithm>

#include "hal/emulation/simulated_node.h"

// SimulatedNode: the drive's state machine, its torque and its supply.

namespace flexarm {

int SimulatedNode::torque_per_mille() const noexcept {
  if (state_ != DriveState::kOperationEnabled) return 0;
  if (Value(kObjectModeDisplay) != kCyclicTorqueMode) return 0;
  const int most = static_cast<int>(Value(kObjectMaxTorque));
  const auto target = static_cast<std::int16_t>(Value(kObjectTargetTorque));
  return std::clamp(static_cast<int>(target), -most, most);
}

void SimulatedNode::Feed(bool fed) noexcept {
  if (supply_) supply_->Feed(fed, bus_->now_ns());
}

// A drive that does not run reports its supply all the same: worse than most.
void SimulatedNode::FollowSupply() noexcept {
  if (!supply_ || nmt_ == NmtState::kBooting) return;
  if (const auto code = supply_->Emergency(bus_->now_ns())) {
    RaiseFault(*code);
    supply_fault_ = true;
  }
  if (supply_fault_ && supply_->model().clears_itself && Supplied()) {
    supply_fault_ = false;
    state_ = DriveState::kSwitchOnDisabled;
  }
}

void SimulatedNode::TakeCommand() noexcept {
  if (command_) {
    std::size_t offset = 0;
    for (std::uint32_t sub = 1; sub <= Value({kObjectRpdoMapping, 0}); ++sub) {
      const std::uint32_t mapped = Value({kObjectRpdoMapping, static_cast<std::uint8_t>(sub)});
      const std::size_t bytes = (mapped & 0xFFU) / 8U;
      if (offset + bytes > command_->length) break;
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < bytes; ++i) {
        value |= std::uint32_t{command_->data[offset + i]} << (8U * i);
      }
      Set({static_cast<std::uint16_t>(mapped >> 16U), static_cast<std::uint8_t>(mapped >> 8U)},
          value);
      offset += bytes;
    }
    command_.reset();
  }
  Follow(static_cast<std::uint16_t>(Value(kObjectControlword)));
}

void SimulatedNode::Follow(std::uint16_t control) noexcept {
  using enum DriveState;
  const bool reset_edge = (control & ~last_control_ & kControlFaultReset) != 0;
  last_control_ = control;
  if (state_ == kFault) {
    if (!reset_edge || !Supplied()) return;
    supply_fault_ = false;
    state_ = kSwitchOnDisabled;
    return;
  }
  // Voltage off, or quick stop, which ends without voltage as there is no speed control.
  if ((control & 0x02U) == 0 || (control & 0x04U) == 0) {
    state_ = kSwitchOnDisabled;
  } else if ((control & 0x07U) == kControlShutdown) {
    state_ = kReadyToSwitchOn;
  } else if ((state_ == kReadyToSwitchOn || state_ == kOperationEnabled) &&
             (control & 0x0FU) == kControlSwitchOn && Supplied()) {
    state_ = kSwitchedOn;
    switched_on_ns_ = bus_->now_ns();
  } else if (state_ == kSwitchedOn && (control & 0x0FU) == kControlEnableOperation) {
    const std::int64_t needs_ns = supply_ ? supply_->model().enable_ns : 0;
    if (bus_->now_ns() - switched_on_ns_ >= needs_ns) state_ = kOperationEnabled;
  }
}

void SimulatedNode::RemoveTorque(DriveState next) noexcept {
  if (state_ != DriveState::kFault) state_ = next;  // only a reset leaves a fault
  command_.reset();
  Set(kObjectControlword, 0);
  Set(kObjectTargetTorque, 0);
}

}  // namespace flexarm
