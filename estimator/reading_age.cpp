#include "estimator/reading_age.h"

#include <array>

namespace flexarm {
namespace {

template <std::size_t N>
std::uint32_t Fresh(const std::array<std::int32_t, N>& offset_ns, std::int64_t frame_age_ns,
                    std::int64_t max_age_ns) noexcept {
  std::uint32_t fresh = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const std::int64_t age_ns = frame_age_ns - offset_ns[i];
    if (age_ns <= max_age_ns && age_ns >= -max_age_ns) fresh |= std::uint32_t{1} << i;
  }
  return fresh;
}

}  // namespace

SensorFrame WithoutStaleReadings(SensorFrame frame, std::int64_t instant_ns,
                                 std::int64_t max_age_ns) noexcept {
  const std::int64_t age_ns = instant_ns - frame.sampled_at_ns;
  frame.counter_valid &= Fresh(frame.counter_offset_ns, age_ns, max_age_ns);
  frame.strain_valid &= Fresh(frame.strain_offset_ns, age_ns, max_age_ns);
  frame.accelerometer_valid &= Fresh(frame.accelerometer_offset_ns, age_ns, max_age_ns);
  return frame;
}

bool StrainsAreOf(const SensorFrame& frame, std::int64_t instant_ns) noexcept {
  const std::uint32_t now = Fresh(frame.strain_offset_ns, instant_ns - frame.sampled_at_ns, 0);
  return (frame.strain_valid & ~now) == 0;
}

}  // namespace flexarm
