#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace flexarm {

/// Wait-free triple buffer: passes the newest value from one writer thread to one reader thread.
/// Older values are dropped.
///
/// Real-time safe on both sides: wait-free, no allocation, no system call; each call copies one T.
/// Three buffers: the writer owns one, the reader owns one, `shared_` has the index of the third.
/// The acq_rel exchange publishes the bytes of T; nothing else synchronises.
template <typename T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>, "a copy of T must not allocate or throw");
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

 public:
  explicit LatestValue(const T& initial) noexcept : buffers_{initial, initial, initial} {}
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// Writer thread only.
  void Publish(const T& value) noexcept {
    buffers_[write_] = value;
    PassOn();
  }

  /// Writer thread only. The same for a value that has grown out of those published before, and out
  /// of the initial one: the buffer, which holds one of them, follows it (T::Follow). For a history
  /// that is published every millisecond, of which only the newest entries differ.
  void PublishGrown(const T& value) noexcept {
    buffers_[write_].Follow(value);
    PassOn();
  }

  /// Reader thread only. The newest published value, or the previous one if none is newer. The
  /// reference stays valid until the next call.
  const T& Read() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & kFresh) != 0) {
      read_ = shared_.exchange(read_, std::memory_order_acq_rel) & kIndex;
    }
    return buffers_[read_];
  }

 private:
  static constexpr std::uint8_t kIndex = 0b011;
  static constexpr std::uint8_t kFresh = 0b100;

  void PassOn() noexcept {
    const std::uint8_t fresh = static_cast<std::uint8_t>(write_ | kFresh);
    write_ = shared_.exchange(fresh, std::memory_order_acq_rel) & kIndex;
  }

  std::array<T, 3> buffers_;
  alignas(64) std::uint8_t write_ = 0;                // owned by the writer
  alignas(64) std::uint8_t read_ = 1;                 // owned by the reader
  alignas(64) std::atomic<std::uint8_t> shared_ = 2;  // index of the third buffer, plus kFresh
};

}  // namespace flexarm
