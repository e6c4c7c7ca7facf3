#include "hal/sim/frame_loss.h"

#include <cmath>

namespace flexarm {
namespace {

// Separate from the noise, which uses the seed itself: lost frames do not change the noise.
constexpr std::uint64_t kFrameLossStream = 0x6c6f7373;

}  // namespace

FrameLoss::FrameLoss(double fraction, std::uint64_t seed)
    : probability_(fraction / (1.0 - fraction)), random_(seed ^ kFrameLossStream) {}

bool FrameLoss::Next() noexcept {
  const double uniform = std::ldexp(static_cast<double>(random_() >> 11), -53);  // 0 .. 1, open
  lost_ = !lost_ && uniform < probability_;
  return lost_;
}

}  // namespace flexarm
