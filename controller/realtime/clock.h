#pragma once

#include <cstdint>

namespace flexarm {

/// CLOCK_MONOTONIC in ns. For executors only: all other code gets its instant as a value.
std::int64_t MonotonicNow() noexcept;

/// CLOCK_REALTIME in ns: only to convert the kernel's time stamps.
std::int64_t RealtimeNow() noexcept;

/// Sleeps until the absolute instant `instant_ns` of CLOCK_MONOTONIC; returns at once if it has
/// passed. Signals do not end the sleep early.
void SleepUntil(std::int64_t instant_ns) noexcept;

}  // namespace flexarm
