#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {

/// Takes an input apart, from its beginning. Behind its end are zeros.
class FuzzReader {
 public:
  explicit FuzzReader(FuzzBytes input) : rest_(input) {}

  bool empty() const noexcept { return rest_.empty(); }

  std::uint8_t Byte() noexcept { return Number<std::uint8_t>(); }

  /// The lowest byte first.
  template <std::unsigned_integral T>
  T Number() noexcept {
    std::uint64_t value = 0;
    unsigned shift = 0;
    for (const std::uint8_t byte : Take(sizeof(T))) {
      value |= std::uint64_t{byte} << shift;
      shift += 8;
    }
    return static_cast<T>(value);
  }

  /// The next `most` bytes, or as many as there are.
  FuzzBytes Take(std::size_t most) noexcept {
    const std::size_t size = std::min(most, rest_.size());
    const FuzzBytes taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }

 private:
  FuzzBytes rest_;
};

}  // namespace flexarm
