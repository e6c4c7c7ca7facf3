#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "estimator/piecewise_torque.h"

namespace flexarm {

/// Hypotheses of the actuation delay, in samples beyond the declared one: -1, 0, 1, 2.
inline constexpr std::size_t kDelays = 4;
inline constexpr std::size_t kDelayAsKnown = 1;

/// The torque over a sample under each hypothesis; empty where that delay is impossible.
using TorqueByDelay = std::array<std::optional<PiecewiseTorque>, kDelays>;

/// Multiple-hypothesis test on the actuation delay: estimates an undeclared delay in whole samples.
/// The hypothesis with the smallest discounted sum of NIS wins.
///
/// Each hypothesis has its own filter (PayloadFilter::Hypothesis). The NIS of its innovations is
/// summed with a forgetting factor, J <- kMemory J + min(NIS, kMost). The test switches to a
/// hypothesis whose J is smaller than that of the current one by more than kBetter, and all sums
/// restart at zero. While the torque is constant, as at rest, all hypotheses predict the same and
/// no sum changes against the others. A sample that no hypothesis explains, as when a payload is
/// lost, is ignored. Source: docs/theory/payload.md 2.7. The design study tests the four angles one
/// by one, a sample ahead from the same state, with 0.97 and 40. Detected delays and detection
/// times: docs/timing.md.
/// Real-time: safe; fixed size.
class DelayDetector {
 public:
  static constexpr double kMemory = 0.99;
  static constexpr double kMost = 200.0;
  static constexpr double kExplained =
      32.0;  ///< bound on the NIS of the right delay: exceeded 1 in 1e4
  static constexpr double kBetter = 40.0;

  /// NIS of a sample under each hypothesis; empty where that delay is impossible.
  using Misfit = std::array<std::optional<double>, kDelays>;

  void Reset() noexcept { *this = DelayDetector(); }

  /// To be called every sample with a reading, in order.
  /// @returns true if the test switches to another hypothesis
  bool Take(const Misfit& misfit) noexcept;

  /// The current hypothesis, as an index of the arrays above.
  std::size_t index() const noexcept { return index_; }
  /// The current hypothesis in samples beyond the declared delay: -1, 0, 1 or 2.
  int samples() const noexcept {
    return static_cast<int>(index_) - static_cast<int>(kDelayAsKnown);
  }

  /// J of the current hypothesis minus the smallest J: the evidence for another hypothesis.
  double lead() const noexcept;

 private:
  std::size_t Best() const noexcept;

  std::array<double, kDelays> unexplained_{};  // J
  std::size_t index_ = kDelayAsKnown;
};

}  // namespace flexarm
