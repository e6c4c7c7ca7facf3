#pragma once

#include <cstdint>

namespace flexarm {

/// State of a CiA 402 drive. kUnknown: the statusword matches no pattern of the profile.
enum class DriveState : std::uint8_t {
  kUnknown,
  kNotReady,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReactionActive,
  kFault,
};

/// Requested state of a drive.
enum class DriveWish : std::uint8_t {
  kOff,         ///< voltage off, immediately
  kOn,          ///< operation enabled, one transition at a time; a fault is never reset
  kResetFault,  ///< a drive in fault is reset, any other is switched off
};

/// Controlwords of CiA 402.
inline constexpr std::uint16_t kControlDisableVoltage = 0x00;
inline constexpr std::uint16_t kControlShutdown = 0x06;
inline constexpr std::uint16_t kControlSwitchOn = 0x07;
inline constexpr std::uint16_t kControlEnableOperation = 0x0F;
inline constexpr std::uint16_t kControlFaultReset = 0x80;  ///< acts on the rising edge of its bit

/// Bit 4 of a statusword (6041), "voltage enabled": the power stage has voltage, in any state.
inline constexpr std::uint16_t kStatusVoltageEnabled = 0x10;
constexpr bool VoltageEnabled(std::uint16_t statusword) noexcept {
  return (statusword & kStatusVoltageEnabled) != 0;
}

/// State of a statusword (6041): bits 0 to 3, 5 and 6.
constexpr DriveState DecodeDriveState(std::uint16_t statusword) noexcept {
  using enum DriveState;
  switch (statusword & 0x4FU) {
    case 0x00:
      return kNotReady;
    case 0x40:
      return kSwitchOnDisabled;
    case 0x0F:
      return kFaultReactionActive;
    case 0x08:
      return kFault;
    default:
      break;
  }
  switch (statusword & 0x6FU) {
    case 0x21:
      return kReadyToSwitchOn;
    case 0x23:
      return kSwitchedOn;
    case 0x27:
      return kOperationEnabled;
    case 0x07:
      return kQuickStopActive;
    default:
      return kUnknown;
  }
}

/// Statusword of a state, as a drive with voltage sends it.
constexpr std::uint16_t EncodeDriveState(DriveState state) noexcept {
  using enum DriveState;
  switch (state) {
    case kUnknown:
      return 0x0020;  // not a pattern of any state
    case kNotReady:
      return 0x0000;
    case kSwitchOnDisabled:
      return 0x0250;
    case kReadyToSwitchOn:
      return 0x0231;
    case kSwitchedOn:
      return 0x0233;
    case kOperationEnabled:
      return 0x0237;
    case kQuickStopActive:
      return 0x0217;
    case kFaultReactionActive:
      return 0x021F;
    case kFault:
      return 0x0218;
  }
  return 0x0020;
}

/// Controlword that moves a drive one transition towards the requested state.
constexpr std::uint16_t ControlwordFor(DriveState state, DriveWish wish) noexcept {
  using enum DriveState;
  if (wish == DriveWish::kResetFault && state == kFault) return kControlFaultReset;
  if (wish != DriveWish::kOn) return kControlDisableVoltage;
  switch (state) {
    case kSwitchOnDisabled:
      return kControlShutdown;
    case kReadyToSwitchOn:
      return kControlSwitchOn;
    case kSwitchedOn:
    case kOperationEnabled:
      return kControlEnableOperation;
    case kUnknown:
    case kNotReady:
    case kQuickStopActive:  // leaves it through "switch on disabled" only
    case kFaultReactionActive:
    case kFault:
      return kControlDisableVoltage;
  }
  return kControlDisableVoltage;
}

}  // namespace flexarm
