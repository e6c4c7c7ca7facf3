#pragma once

#include <cstdint>

namespace flexarm {

/// CLOCK_MONOTONIC in ns. Executors only: everything else gets its instant as a value.
std::int64_t MonotonicNow() noexcept;

/// CLOCK_REALTIME in ns: only to convert the kernel's time stamps.
std::int64_t RealtimeNow() noexcept;

/// Sleeps until that absolute instant of CLOCK_MONOTONIC; at once if it has passed. Signals do not
/// end it early.
void SleepUntil(std::int64_t instant_ns) noexcept;

}  // namespace flexarm
