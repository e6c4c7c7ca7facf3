#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace flexarm {

/// How many of the last n events were failures: the count of an m-of-n limit.
///
/// Finds failures that never follow each other, which a limit of consecutive failures does not.
/// Before n events have come, the missing ones count as successes. A ring of bits; constexpr.
/// Real-time: safe.
class WindowedCount {
 public:
  static constexpr int kLongest = 256;  ///< largest n

  /// @param length  n, in 1..kLongest; others are clamped
  explicit constexpr WindowedCount(int length) noexcept
      : length_(std::clamp(length, 1, kLongest)) {}

  constexpr void Push(bool failed) noexcept {
    std::uint64_t& word = bits_[static_cast<std::size_t>(next_) / kWordBits];
    const unsigned bit = static_cast<unsigned>(next_) % kWordBits;
    const int leaves = static_cast<int>(word >> bit & 1u);
    const int enters = failed ? 1 : 0;
    word ^= static_cast<std::uint64_t>(leaves ^ enters) << bit;
    count_ += enters - leaves;
    next_ = next_ + 1 == length_ ? 0 : next_ + 1;
  }

  /// `failures` failures one after the other, as after an outage. Bounded: at most n matter.
  constexpr void PushFailures(std::int64_t failures) noexcept {
    for (std::int64_t i = std::min<std::int64_t>(failures, length_); i > 0; --i) Push(true);
  }

  constexpr int count() const noexcept { return count_; }

 private:
  static constexpr std::size_t kWordBits = 64;

  std::array<std::uint64_t, kLongest / kWordBits> bits_{};  // 1: a failure
  int length_;
  int next_ = 0;  // the oldest event, which the next one replaces
  int count_ = 0;
};

}  // namespace flexarm
