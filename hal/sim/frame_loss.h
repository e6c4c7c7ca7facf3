#pragma once

#include <cstdint>
#include <random>

namespace flexarm {

/// Which frames of a simulated bus are lost: a share of them, each one alone.
///
/// Two frames in a row without a reading are a lost bus, and a trip (docs/safety.md), so the frame
/// after a lost one arrives; any other is lost with probability p / (1 - p), which makes the share
/// p. One seeded generator: same seed, same losses. Real-time: Next is safe.
class FrameLoss {
 public:
  /// @param fraction  p, 0 .. 0.5
  FrameLoss(double fraction, std::uint64_t seed);

  /// True: the next frame is lost.
  bool Next() noexcept;

 private:
  double probability_;
  bool lost_ = false;
  std::mt19937_64 random_;
};

}  // namespace flexarm
