#pragma once

#include <cstdint>

namespace flexarm {

/// CLOCK_MONOTONIC in ns. Executors only: everything else gets its instant as a value.
std::int64_t MonotonicNow() noexcept;

/// Sleeps until that absolute instant of CLOCK_MONOTONIC; at once if it has passed. Signals do not
/// end it early.
void SleepUntil(std::int64_t instant_ns) noexcept;

}  // namespace flexarm
