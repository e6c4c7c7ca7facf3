#pragma once

#include <array>
#include <cstdint>

#include "hal/sensor_frame.h"

namespace flexarm {

/// Of each counter: how often it may have lost its count since its device was opened. A change
/// means that the counts before and after have no common zero.
using CountEpochs = std::array<std::uint32_t, kCounters>;

}  // namespace flexarm
