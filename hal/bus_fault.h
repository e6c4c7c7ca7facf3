#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

namespace flexarm {

/// What an exchange with a bus met, in its device's own numbers: BusDevice::FaultText says it in
/// words. Four bytes, so that a real-time thread can hand it on and a log can keep it.
struct BusFault {
  std::uint8_t kind = 0;   ///< 0: nothing
  std::uint8_t node = 0;   ///< node or unit that it is of; 0: the bus
  std::uint16_t code = 0;  ///< what the device or the node says itself

  friend bool operator==(const BusFault&, const BusFault&) = default;
};
static_assert(std::is_trivially_copyable_v<BusFault> && sizeof(BusFault) == 4);

/// Kind of every device: an exchange does not end. Said of a bus, never by it.
inline constexpr std::uint8_t kBusHangs = 0xFF;

constexpr std::uint32_t ToBits(const BusFault& fault) noexcept {
  return std::bit_cast<std::uint32_t>(fault);
}
constexpr BusFault FaultFromBits(std::uint32_t bits) noexcept {
  return std::bit_cast<BusFault>(bits);
}

}  // namespace flexarm
