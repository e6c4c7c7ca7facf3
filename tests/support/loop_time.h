#pragma once

#include <cstdint>

#include "hal/time_units.h"

namespace flexarm {

/// A millisecond, in the unit of all clocks of the loop.
inline constexpr std::int64_t kMs = kMillisecondNs;

/// The control period of every shipped rig.
inline constexpr double kPeriod_s = 0.02;
inline constexpr std::int64_t kPeriodNs = 20 * kMs;

}  // namespace flexarm
