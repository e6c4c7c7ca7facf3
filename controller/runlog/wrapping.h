#pragma once

#include <cstdint>

namespace flexarm {

// Arithmetic with numbers of a file, which may have any values: a result that does not fit wraps
// around. Real-time: safe.

/// a + b, modulo 2^64.
constexpr std::int64_t WrappedSum(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
/// a - b, modulo 2^64.
constexpr std::int64_t WrappedDifference(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}
/// a * b, modulo 2^64.
constexpr std::int64_t WrappedProduct(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) * static_cast<std::uint64_t>(b));
}

}  // namespace flexarm
