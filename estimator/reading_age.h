#pragma once

#include <cstdint>

#include "hal/sensor_frame.h"

namespace flexarm {

/// `frame` with every reading marked not valid that was taken more than `max_age_ns` before or
/// after `instant_ns`. A reading was taken at sampled_at + its offset, both in the clock of the
/// loop.
/// Real-time: safe.
SensorFrame WithoutStaleReadings(SensorFrame frame, std::int64_t instant_ns,
                                 std::int64_t max_age_ns) noexcept;

/// True if every good strain reading was taken at `instant_ns`. Real-time: safe.
bool StrainsAreOf(const SensorFrame& frame, std::int64_t instant_ns) noexcept;

}  // namespace flexarm
