#include "hal/comedi/scan_clock.h"

#include <algorithm>

namespace flexarm {
namespace {

constexpr std::int64_t kSlowness = 64;          // 1.3 s at 50 Hz: 100 ppm of drift are 0.13 ms
constexpr std::int64_t kStartNs = 100'000'000;  // for a board to start, and a driver that polls it

}  // namespace

void ScanClock::Restart(std::int64_t instant_ns) noexcept {
  newest_end_ns_ = instant_ns;
  running_ = false;
  late_ = false;
  early_ = false;
}

void ScanClock::Take(std::int64_t begin_ns, std::int64_t end_ns, std::int64_t scans) noexcept {
  const std::int64_t patience_ns = interval_ns_ + transfer_ns_;
  if (!running_ && scans == 0) {
    // Boards begin to convert up to an interval after the start; then a whole scan has to end.
    late_ = begin_ns - newest_end_ns_ > 2 * interval_ns_ + patience_ns + kStartNs;
    return;
  }
  const std::int64_t earliest_ns = begin_ns - patience_ns;
  const std::int64_t middle_ns = earliest_ns + (end_ns - earliest_ns) / 2;
  const std::int64_t counted_ns = running_ ? newest_end_ns_ + scans * interval_ns_ : middle_ns;
  running_ = true;
  late_ = late_ || counted_ns < earliest_ns - patience_ns;
  early_ = early_ || counted_ns > end_ns + patience_ns;
  const std::int64_t drawn_ns = counted_ns + (middle_ns - counted_ns) / kSlowness;
  // A late scan keeps its age.
  newest_end_ns_ = late_ ? counted_ns : std::clamp(drawn_ns, earliest_ns, end_ns);
}

}  // namespace flexarm
