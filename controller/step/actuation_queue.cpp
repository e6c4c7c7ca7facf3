#include "controller/step/actuation_queue.h"

#include <algorithm>

namespace flexarm {
namespace {

constexpr std::int64_t kMostPeriods = 6;

}  // namespace

void ActuationQueue::Push(std::int64_t from_ns, const std::array<double, 2>& torque_nm) noexcept {
  if (size_ == kEntries) {
    std::move(entry_.begin() + 1, entry_.end(), entry_.begin());
    --size_;
  }
  if (size_ > 0) from_ns = std::max(from_ns, entry_[size_ - 1].from_ns);
  entry_[size_++] = {.from_ns = from_ns, .torque_nm = torque_nm};
}

void ActuationQueue::CorrectNewest(std::int64_t from_ns) noexcept {
  if (size_ == 0) return;
  entry_[size_ - 1].from_ns = size_ > 1 ? std::max(from_ns, entry_[size_ - 2].from_ns) : from_ns;
}

PiecewiseTorque ActuationQueue::Between(std::int64_t start_ns, std::int64_t end_ns,
                                        std::int64_t period_ns) const noexcept {
  end_ns = std::min(end_ns, start_ns + kMostPeriods * period_ns);
  const auto ticks = [start_ns, period_ns](std::int64_t at_ns) {
    return ((at_ns - start_ns) * kPeriodTicks + period_ns / 2) / period_ns;
  };
  PiecewiseTorque pieces;
  std::array<double, 2> torque_nm{};
  std::int64_t done = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    const Entry& entry = entry_[i];
    if (entry.from_ns >= end_ns) break;
    if (entry.from_ns > start_ns) {
      const std::int64_t border = ticks(entry.from_ns);
      pieces.Add({.torque_nm = torque_nm, .ticks = border - done});
      done = border;
    }
    torque_nm = entry.torque_nm;
  }
  if (end_ns > start_ns) pieces.Add({.torque_nm = torque_nm, .ticks = ticks(end_ns) - done});
  return pieces;
}

}  // namespace flexarm
