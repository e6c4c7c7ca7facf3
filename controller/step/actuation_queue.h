#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "estimator/piecewise_torque.h"

namespace flexarm {

/// Asked torques, each with the instant from which it acts until the next one does: those that act
/// and those that do not act yet. Before the first one the torque is zero. Holds eight, more than a
/// delay of five periods needs.
///
/// Real-time: safe.
class ActuationQueue {
 public:
  void Clear() noexcept { size_ = 0; }

  /// @param from_ns  the torque acts from then on; not before the newest: clamped to its instant
  void Push(std::int64_t from_ns, const std::array<double, 2>& torque_nm) noexcept;

  /// Sets the instant of the newest torque to the measured one. No effect on an empty queue.
  void CorrectNewest(std::int64_t from_ns) noexcept;

  /// The torque from `start_ns` to `end_ns`, at most six periods later. Instants of change are
  /// rounded to ticks since `start_ns`, so that rounding errors do not accumulate.
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
