#pragma once

#include <cstdint>

namespace flexarm {

/// Clocks in ns since their epochs. Injected into the drivers, as only executors read clocks.
struct BusClocks {
  std::int64_t (*monotonic_ns)() noexcept;
  std::int64_t (*realtime_ns)() noexcept;  ///< CLOCK_REALTIME: the kernel's time stamps of frames
};

}  // namespace flexarm
