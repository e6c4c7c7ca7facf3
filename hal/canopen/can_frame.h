#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace flexarm {

/// A classic CAN data frame with an 11-bit identifier. Bytes beyond `length` are zero.
struct CanFrame {
  std::uint32_t id = 0;
  std::uint8_t length = 0;  ///< 0..8
  std::array<std::uint8_t, 8> data{};

  friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

/// A frame received from the bus.
struct ReceivedFrame {
  CanFrame frame;
  std::int64_t at_ns;  ///< end of the frame on the bus, CLOCK_MONOTONIC
  bool own;            ///< echo of a frame sent from this end
};

/// Unsigned number at `offset`, least significant byte first, as in CANopen.
template <std::unsigned_integral Number>
constexpr Number LoadLe(std::span<const std::uint8_t> bytes, std::size_t offset) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    value |= std::uint64_t{bytes[offset + i]} << (8U * i);
  }
  return static_cast<Number>(value);
}

/// Inverse of LoadLe.
template <std::unsigned_integral Number>
constexpr void StoreLe(std::span<std::uint8_t> bytes, std::size_t offset, Number value) noexcept {
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes[offset + i] = static_cast<std::uint8_t>(std::uint64_t{value} >> (8U * i));
  }
}

/// Longest duration of a frame with `length` data bytes, in bits: 47 + 8 n of frame and pause,
/// and a stuff bit after every fourth bit of the 34 + 8 n that are stuffed.
constexpr int WorstCaseBits(int length) noexcept { return 47 + 8 * length + (33 + 8 * length) / 4; }

/// The same in ns. `bitrate_bps` > 0.
constexpr std::int64_t FrameTimeNs(int length, int bitrate_bps) noexcept {
  return std::int64_t{WorstCaseBits(length)} * 1'000'000'000 / bitrate_bps;
}

}  // namespace flexarm
