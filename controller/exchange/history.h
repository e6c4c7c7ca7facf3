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
    newest_ = After(newest_);
    ++pushed_;
    Entry& entry = entries_[static_cast<std::size_t>(newest_)];
    entry.from_ns = from_ns;
    entry.value = value;
  }

  /// Becomes equal to `newer`, of which this is an earlier state, or which began with the same
  /// initial value: copies only what was pushed since.
  void Follow(const History& newer) noexcept {
    if (newer.pushed_ - pushed_ >= std::uint64_t{N}) {
      *this = newer;
      return;
    }
    for (; pushed_ != newer.pushed_; ++pushed_) {
      newest_ = After(newest_);
      const auto at = static_cast<std::size_t>(newest_);
      entries_[at] = newer.entries_[at];
    }
  }

  /// The value that holds at `now_ns`; the oldest stored one if all are newer.
  const Entry& At(std::int64_t now_ns) const noexcept {
    const std::int32_t oldest = After(newest_);
    std::int32_t at = newest_;
    while (at != oldest && entries_[static_cast<std::size_t>(at)].from_ns > now_ns) {
      at = at == 0 ? N - 1 : at - 1;
    }
    return entries_[static_cast<std::size_t>(at)];
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
  static std::int32_t After(std::int32_t at) noexcept { return at == N - 1 ? 0 : at + 1; }

  std::array<Entry, static_cast<std::size_t>(N)> entries_;
  std::int32_t newest_ = 0;
  std::uint64_t pushed_ = 0;  // since the construction
};

}  // namespace flexarm
