#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace flexarm {

/// What a Modbus device can do wrong on its wire.
enum class WireFault : std::uint8_t {
  kNone,
  kSilent,            ///< takes requests, never answers
  kLate,              ///< each reply some time later
  kOneBehind,         ///< answers each request with the reply to the one before, for ever
  kByteByByte,        ///< a byte every 20 ms
  kWrongTransaction,  ///< TCP
  kWrongProtocol,     ///< TCP
  kWrongFrameLength,  ///< TCP: the header's length field is not the frame's
  kWrongUnit,
  kWrongFunction,
  kLongPayload,   ///< a register more than asked for, all lengths consistent
  kShortPayload,  ///< nothing where something was asked for
  kHugePayload,   ///< says 255 bytes
  kBadChecksum,   ///< RTU
  kGarbage,       ///< 64 bytes 0xFF in place of a reply
  kThreeBytes,    ///< and nothing after them
  kHalfFrame,     ///< and nothing after it
  kHalfFrameThenClose,
  kTwice,  ///< each reply twice
  kException,
  kFlood,       ///< sends without being asked, 16 MB/s
  kReset,       ///< TCP: RST in place of a reply
  kClose,       ///< TCP: in place of a reply
  kNeverReads,  ///< TCP: leaves requests in its buffer, which is small
  kAway,        ///< unplugged: connections, listener or terminal closed; back with any other
};
inline constexpr int kWireFaults = 25;

/// As in commands: "byte-by-byte"; kNone is "well".
const char* Name(WireFault fault) noexcept;

/// Nothing if there is no such fault.
std::optional<WireFault> WireFaultByName(std::string_view name) noexcept;

}  // namespace flexarm
