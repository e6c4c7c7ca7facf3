#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace flexarm {

/// The last N values of a signal with the instants from which they hold.
///
/// A task publishes its history through LatestValue; a reader asks for the value that held at a
/// logical instant. So what a task sees depends on the time grid alone, not on which thread woke
/// first: a real-time run in which every task publishes before the instant from which its value
/// holds sees exactly what the lock-step run sees.
/// Real-time: safe. Trivially copyable if T is.
template <typename T, int N>
class History {
 public:
  struct Entry {
    std::int64_t from_ns;  ///< the value holds from this instant on
    T value;
  };

  explicit History(const T& initial) noexcept {
    entries_.fill(Entry{.from_ns = INT64_MIN, .value = initial});
  }

  /// Instants must not go back.
  void Push(std::int64_t from_ns, const T& value) noexcept {
    newest_ = (newest_ + 1) % N;
    entries_[static_cast<std::size_t>(newest_)] = Entry{.from_ns = from_ns, .value = value};
  }

  /// The value that holds at `now_ns`; the oldest one kept if all are newer.
  const Entry& At(std::int64_t now_ns) const noexcept {
    for (int back = 0; back < N - 1; ++back) {
      const Entry& entry = entries_[static_cast<std::size_t>((newest_ + N - back) % N)];
      if (entry.from_ns <= now_ns) return entry;
    }
    return entries_[static_cast<std::size_t>((newest_ + 1) % N)];
  }

  const Entry& Newest() const noexcept { return entries_[static_cast<std::size_t>(newest_)]; }

 private:
  std::array<Entry, static_cast<std::size_t>(N)> entries_;
  std::int32_t newest_ = 0;
};

}  // namespace flexarm
