#pragma once

#include <cstdint>

namespace flexarm {

/// When the newest scan of a board ended, in our clock.
///
/// The board scans by its own clock and tells nothing of it. But a scan that could be read had
/// ended before, and the one after it, which could not, had not ended by more than a transfer: so
/// each reading says that the newest scan ended within one interval and one transfer before it.
/// Between readings scans are counted, and their number times the interval is known far better.
/// The end is therefore counted on from the last one, drawn to the middle of what the reading says
/// by 1/64, and held within it: time between frames is true to some tens of microseconds, and no
/// drift between the clocks carries the end away. Its error is at most half of (interval +
/// transfer + the reading), and what 64 readings drift.
/// Real-time: safe.
class ScanClock {
 public:
  ScanClock(std::int64_t interval_ns, std::int64_t transfer_ns)
      : interval_ns_(interval_ns), transfer_ns_(transfer_ns) {}

  /// Forgets everything; the scan is started at `instant_ns`.
  void Restart(std::int64_t instant_ns) noexcept;

  /// One reading, begun and ended at these instants, gave so many complete scans.
  void Take(std::int64_t begin_ns, std::int64_t end_ns, std::int64_t scans) noexcept;

  /// A scan has ended since the restart.
  bool running() const noexcept { return running_; }
  /// The end of the newest one.
  std::int64_t newest_end_ns() const noexcept { return newest_end_ns_; }
  /// The newest scan should have been there more than an interval and a transfer earlier. Lasts
  /// until Restart: where the board's scans lie is not known any more.
  bool late() const noexcept { return late_; }
  /// More scans have come than there can be: the board's interval is another. Lasts as well.
  bool early() const noexcept { return early_; }

 private:
  std::int64_t interval_ns_;
  std::int64_t transfer_ns_;
  std::int64_t newest_end_ns_ = 0;  // before the first scan: the restart
  bool running_ = false;
  bool late_ = false;
  bool early_ = false;
};

}  // namespace flexarm
