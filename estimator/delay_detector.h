#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "estimator/piecewise_torque.h"

namespace flexarm {

/// Delays of the torque, in samples more than is known: one less, as known, one more, two more.
inline constexpr std::size_t kDelays = 4;
inline constexpr std::size_t kDelayAsKnown = 1;

/// The torque over a sample under each of them; nothing where that delay is out of the question.
using TorqueByDelay = std::array<std::optional<PiecewiseTorque>, kDelays>;

/// Finds a delay of whole samples that nobody knows of: that whose torques explain the readings
/// best.
///
/// Each delay has a filter of its own (PayloadFilter::Hypothesis). The squares of its innovations
/// add up, J <- kMemory J + min(NIS, kMost); a delay that is better by more than kBetter takes
/// over, and all begin again at zero. Where torques do not change, as at rest, all delays predict
/// the same and none gains. A sample that no delay explains, as when a load is dropped, says
/// nothing. Source: docs/theory/payload.md 2.7. The design study looks at the four angles one by
/// one and a sample ahead from the same state, with 0.97 and 40. What these numbers find, and when:
/// docs/timing.md.
/// Real-time: safe; fixed size.
class DelayDetector {
 public:
  static constexpr double kMemory = 0.99;
  static constexpr double kMost = 200.0;
  static constexpr double kExplained = 32.0;  ///< NIS that the right delay stays below: 1 in 1e4
  static constexpr double kBetter = 40.0;

  /// NIS of a sample under each delay; nothing of one that is out of the question.
  using Misfit = std::array<std::optional<double>, kDelays>;

  void Reset() noexcept { *this = DelayDetector(); }

  /// Every sample with a reading, in order.
  /// @returns true when another delay takes over
  bool Take(const Misfit& misfit) noexcept;

  /// The delay that holds, as an index of the arrays above.
  std::size_t index() const noexcept { return index_; }
  /// The same in samples beyond the known one: -1, 0, 1 or 2.
  int samples() const noexcept {
    return static_cast<int>(index_) - static_cast<int>(kDelayAsKnown);
  }

  /// J of that delay beyond the least: how much speaks for another.
  double lead() const noexcept;

 private:
  std::size_t Best() const noexcept;

  std::array<double, kDelays> unexplained_{};  // J
  std::size_t index_ = kDelayAsKnown;
};

}  // namespace flexarm
