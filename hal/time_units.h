#pragma once

#include <cstdint>

namespace flexarm {

// Instants and durations are whole nanoseconds.
inline constexpr std::int64_t kMillisecondNs = 1'000'000;
inline constexpr std::int64_t kSecondNs = 1'000'000'000;

}  // namespace flexarm
