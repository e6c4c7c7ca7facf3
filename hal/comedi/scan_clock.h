#pragma once

#include <cstdint>

namespace flexarm {

/// Estimates the end of a board's newest scan in the clock of the loop.
///
/// The board scans by its own clock, which cannot be read. But a scan that could be read had ended
/// before, and the next one, which could not, had not ended by more than a transfer: so each
/// reading bounds the end of the newest scan to one interval and one transfer before it. Between
/// readings the end advances by the number of scans times the interval, which is known far better.
/// The estimate is therefore the advanced end, moved towards the middle of the reading's bounds by
/// 1/64 and clamped to them: times between frames are accurate to some tens of microseconds, and
/// drift between the clocks does not accumulate. Its error is at most half of (interval + transfer
/// + the reading), plus the drift during 64 readings.
/// Real-time: safe.
class ScanClock {
 public:
  ScanClock(std::int64_t interval_ns, std::int64_t transfer_ns)
      : interval_ns_(interval_ns), transfer_ns_(transfer_ns) {}

  /// Resets the estimate; the scan is started at `instant_ns`.
  void Restart(std::int64_t instant_ns) noexcept;

  /// Adds one reading: its start, its end, and the number of complete scans read.
  void Take(std::int64_t begin_ns, std::int64_t end_ns, std::int64_t scans) noexcept;

  /// True if a scan has ended since the restart.
  bool running() const noexcept { return running_; }
  /// Estimated end of the newest scan.
  std::int64_t newest_end_ns() const noexcept { return newest_end_ns_; }
  /// The newest scan is overdue by more than an interval and a transfer. Lasts until Restart: the
  /// phase of the board's scans is unknown then.
  bool late() const noexcept { return late_; }
  /// More scans have arrived than possible: the board's interval differs. Lasts until Restart.
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
