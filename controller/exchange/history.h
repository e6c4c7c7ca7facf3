#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace flexarm {

/// History buffer: the last N values of a signal, each with the instant from which it holds.
///
/// A task publishes its history through LatestValue; a reader asks for the value that held at a
/// logical instant. So the values that a task reads depend on the time grid alone and not on the
/// order in which threads woke: a real-time run in which every task publishes each value before the
/// instant from which it holds reads the same values as the lock-step run.
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

  /// Instants must not decrease.
  void Push(std::int64_t from_ns, const T& value) noexcept {
    newest_ = (newest_ + 1) % N;
    entries_[static_cast<std::size_t>(newest_)] = Entry{.from_ns = from_ns, .value = value};
  }

  /// The value that holds at `now_ns`; the oldest stored one if all are newer.
  const Entry& At(std::int64_t now_ns) const noexcept {
    for (int back = 0; back < N - 1; ++back) {
      const Entry& entry = entries_[static_cast<std::size_t>((newest_ + N - back) % N)];
      if (entry.from_ns <= now_ns) return entry;
    }
    return entries_[static_cast<std::size_t>((newest_ + 1) % N)];
  }

  /// Calls `look` with each stored value that began to hold after `after_ns` and until `until_ns`.
  template <typename Look>
  void ForEach(std::int64_t after_ns, std::int64_t until_ns, Look look) const noexcept {
    for (const Entry& entry : entries_) {
      if (entry.from_ns > after_ns && entry.from_ns <= until_ns) look(entry.value);
    }
  }

  const Entry& Newest() const noexcept { return entries_[static_cast<std::size_t>(newest_)]; }

 private:
  std::array<Entry, static_cast<std::size_t>(N)> entries_;
  std::int32_t newest_ = 0;
};

}  // namespace flexarm
