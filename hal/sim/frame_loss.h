#pragma once

#include <cstdint>
#include <random>

namespace flexarm {

/// Random loss of frames on a simulated bus, never two in a row.
///
/// Two frames in a row without a reading are a lost bus, and a trip (docs/safety.md), so the frame
/// after a lost one arrives; any other is lost with probability p / (1 - p), which makes the
/// fraction p. One seeded generator: same seed, same losses. Real-time: Next is safe.
class FrameLoss {
 public:
  /// @param fraction  p, 0 .. 0.5
  FrameLoss(double fraction, std::uint64_t seed);

  /// Returns true if the next frame is lost.
  bool Next() noexcept;

 private:
  double probability_;
  bool lost_ = false;
  std::mt19937_64 random_;
};

}  // namespace flexarm
