#include "hal/canopen/arrival_clock.h"

#include <algorithm>

namespace flexarm {
namespace {

// Rounding of the two clocks to ns, and processors whose counters differ a little.
constexpr std::int64_t kRounding_ns = 1000;

}  // namespace

void ArrivalClock::Begin(std::int64_t now_ns) noexcept {
  *this = ArrivalClock{};
  since_ns_ = now_ns_ = now_ns;
}

void ArrivalClock::Take(const ClockReading& reading) noexcept {
  const Offset found{.least_ns = reading.realtime_ns - reading.after_ns,
                     .most_ns = reading.realtime_ns - reading.before_ns};
  now_ns_ = reading.after_ns;
  if (!known_) {
    known_ = true;
    present_ = before_ = found;
    stepped_ns_ = now_ns_;
    return;
  }
  const Offset both{.least_ns = std::max(present_.least_ns, found.least_ns),
                    .most_ns = std::min(present_.most_ns, found.most_ns)};
  if (both.least_ns <= both.most_ns + kRounding_ns) {
    present_ = both;
    return;
  }
  before_ = present_;
  present_ = found;
  stepped_ns_ = now_ns_;
}

std::int64_t ArrivalClock::ArrivalOf(std::int64_t stamp_ns) const noexcept {
  if (stamp_ns == 0) return since_ns_;
  const std::int64_t oldest_ns = since_ns_ - kInDelivery_ns;
  const std::int64_t now = stamp_ns - present_.most_ns;
  const std::int64_t before = stamp_ns - before_.most_ns;
  const bool is_now = now >= oldest_ns && now <= now_ns_;
  const bool is_before = before >= oldest_ns && before <= std::min(stepped_ns_, now_ns_);
  if (is_now && is_before) return std::min(now, before);
  if (is_now) return now;
  return is_before ? before : oldest_ns;
}

}  // namespace flexarm
