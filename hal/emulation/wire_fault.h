#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace flexarm {

/// Injected faults of a Modbus device on its wire.
enum class WireFault : std::uint8_t {
  kNone,
  kSilent,            ///< accepts requests, never answers
  kLate,              ///< delays each reply
  kOneBehind,         ///< answers each request with the reply to the previous one
  kByteByByte,        ///< a byte every 20 ms
  kWrongTransaction,  ///< TCP
  kWrongProtocol,     ///< TCP
  kWrongFrameLength,  ///< TCP: the header's length field is not the frame's
  kWrongUnit,
  kWrongFunction,
  kLongPayload,   ///< a register more than requested, all lengths consistent
  kShortPayload,  ///< an empty payload
  kHugePayload,   ///< byte count 255
  kBadChecksum,   ///< RTU
  kGarbage,       ///< 64 bytes 0xFF in place of a reply
  kThreeBytes,    ///< then nothing
  kHalfFrame,     ///< then nothing
  kHalfFrameThenClose,
  kTwice,  ///< sends each reply twice
  kException,
  kFlood,       ///< sends unrequested data, 16 MB/s
  kReset,       ///< TCP: RST instead of a reply
  kClose,       ///< TCP: closes instead of a reply
  kNeverReads,  ///< TCP: does not read its receive buffer, which is small
  kAway,        ///< unplugged: connections, listener or terminal closed, until another fault
};
inline constexpr int kWireFaults = 25;

/// Name of a fault in commands: "byte-by-byte"; kNone is "well".
const char* ToString(WireFault fault) noexcept;

/// The fault with this name; empty if there is none.
std::optional<WireFault> WireFaultByName(std::string_view name) noexcept;

}  // namespace flexarm
