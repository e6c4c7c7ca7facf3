#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

namespace flexarm {

/// Fault of an exchange with a bus, in its device's own numbers; BusDevice::FaultText gives the
/// text. Four bytes: real-time threads can copy it and the log can store it.
struct BusFault {
  std::uint8_t kind = 0;   ///< 0: no fault
  std::uint8_t node = 0;   ///< node or unit with the fault; 0: the bus
  std::uint16_t code = 0;  ///< code reported by the device or the node

  friend bool operator==(const BusFault&, const BusFault&) = default;
};
static_assert(std::is_trivially_copyable_v<BusFault> && sizeof(BusFault) == 4);

/// Kind valid for every device: an exchange does not return. Set by the monitor, not by the bus.
inline constexpr std::uint8_t kBusHangs = 0xFF;

constexpr std::uint32_t ToBits(const BusFault& fault) noexcept {
  return std::bit_cast<std::uint32_t>(fault);
}
constexpr BusFault FaultFromBits(std::uint32_t bits) noexcept {
  return std::bit_cast<BusFault>(bits);
}

}  // namespace flexarm
