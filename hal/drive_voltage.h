#pragma once

#include <cstdint>

namespace flexarm {

/// What the drives report of the voltage at their power stages (the DC link). Bit i: the drive of
/// joint i + 1. A drive in neither set: its voltage is not known.
struct DriveVoltage {
  std::uint8_t on = 0;   ///< those with voltage
  std::uint8_t off = 0;  ///< those without
};

/// That of two buses together.
constexpr DriveVoltage Joined(const DriveVoltage& a, const DriveVoltage& b) noexcept {
  return {.on = static_cast<std::uint8_t>(a.on | b.on),
          .off = static_cast<std::uint8_t>(a.off | b.off)};
}

/// How soon the reported voltage follows the power through relay and charge pump.
struct DriveVoltageTimes {
  double rise_ms;  ///< from the command to close until every drive has voltage, at most
  double fall_ms;  ///< from the command to open until no drive has voltage, at most
};

}  // namespace flexarm
