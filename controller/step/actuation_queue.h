#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "estimator/piecewise_torque.h"

namespace flexarm {

/// Torques and the instants from which each acts until the next: what was asked and is still on its
/// way. Before the first one, no torque. Remembers eight: more than five periods of delay need.
///
/// Real-time: safe.
class ActuationQueue {
 public:
  void Clear() noexcept { size_ = 0; }

  /// Acts from `from_ns` on; an instant before the newest one's counts as that.
  void Push(std::int64_t from_ns, const std::array<double, 2>& torque_nm) noexcept;

  /// The newest torque began at `from_ns`, as it turned out. Nothing if there is none.
  void CorrectNewest(std::int64_t from_ns) noexcept;

  /// The torque from `start_ns` to `end_ns`, at most six periods later. Borders are rounded to
  /// ticks from the start, so that errors do not add up.
  PiecewiseTorque Between(std::int64_t start_ns, std::int64_t end_ns,
                          std::int64_t period_ns) const noexcept;

 private:
  struct Entry {
    std::int64_t from_ns;
    std::array<double, 2> torque_nm;
  };
  static constexpr std::size_t kEntries = PiecewiseTorque::kMost;

  std::array<Entry, kEntries> entry_{};  // in order of time
  std::size_t size_ = 0;
};

}  // namespace flexarm
