#pragma once

#include <cstdint>

namespace flexarm {

/// CLOCK_REALTIME, read between two readings of CLOCK_MONOTONIC. In ns.
struct ClockReading {
  std::int64_t before_ns;    ///< CLOCK_MONOTONIC
  std::int64_t realtime_ns;  ///< CLOCK_REALTIME
  std::int64_t after_ns;     ///< CLOCK_MONOTONIC
};

/// Instant of arrival of a received frame in CLOCK_MONOTONIC, from the kernel's time stamp, which
/// is CLOCK_REALTIME, the time of day.
///
/// The two clocks differ by an offset that is constant, but for steps of the time of day (slewing
/// changes both). So each reading narrows the known offset, or shows a step. A frame that was read
/// after a step may have been stamped before or after it: of the present offset and the one before
/// it, only those count that give an arrival which is possible, and of two possible ones the older.
/// So a step of more than kInDelivery_ns and a period moves no arrival, and a smaller one makes it
/// too old, for one period at most. No step makes a frame younger than it is.
///
/// Real-time safe. Thread: one.
class ArrivalClock {
 public:
  /// A frame may be stamped, and not in the socket yet, when the socket is found empty.
  static constexpr std::int64_t kInDelivery_ns = 5'000'000;

  /// Forgets everything. @param now_ns  CLOCK_MONOTONIC: no frame arrived earlier
  void Begin(std::int64_t now_ns) noexcept;

  /// The socket was found empty, later than `instant_ns` of CLOCK_MONOTONIC: what is read from now
  /// on arrived later, or was in delivery.
  void Emptied(std::int64_t instant_ns) noexcept { since_ns_ = instant_ns; }

  /// Call after each frame is read, and before ArrivalOf.
  void Take(const ClockReading& reading) noexcept;

  /// CLOCK_MONOTONIC of the arrival of the frame with this stamp; without a stamp (0), or with one
  /// that is impossible, the oldest possible instant.
  std::int64_t ArrivalOf(std::int64_t stamp_ns) const noexcept;

 private:
  // CLOCK_REALTIME minus CLOCK_MONOTONIC is in this interval.
  struct Offset {
    std::int64_t least_ns;
    std::int64_t most_ns;
  };

  bool known_ = false;
  Offset present_{};
  Offset before_{};              // before the last step
  std::int64_t stepped_ns_ = 0;  // that step was not later than this
  std::int64_t since_ns_ = 0;    // the socket was empty after this
  std::int64_t now_ns_ = 0;      // the last reading
};

}  // namespace flexarm
