#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace flexarm {

/// Counts, since Open, of what a driver rejected, missed or could not send. Their names, in the
/// same order: BusDevice::counter_names. The rest is 0.
inline constexpr std::size_t kMostBusCounters = 8;
using BusCounters = std::array<std::uint32_t, kMostBusCounters>;

}  // namespace flexarm
