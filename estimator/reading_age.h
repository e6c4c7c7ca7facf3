#pragma once

#include <cstdint>

#include "hal/sensor_frame.h"

namespace flexarm {

/// `frame` with every reading marked not valid that is older than `max_age_ns` at `instant_ns`, or
/// from after it by more than that: it says nothing about this instant. A reading was taken at
/// sampled_at + its offset, both in the clock of the loop.
/// Real-time: safe.
SensorFrame WithoutStaleReadings(SensorFrame frame, std::int64_t instant_ns,
                                 std::int64_t max_age_ns) noexcept;

/// True if every good strain reading was taken at `instant_ns`. Real-time: safe.
bool StrainsAreOf(const SensorFrame& frame, std::int64_t instant_ns) noexcept;

}  // namespace flexarm
