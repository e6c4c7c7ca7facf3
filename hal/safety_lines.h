#pragma once

#include <cstdint>

#include "hal/sensor_frame.h"

namespace flexarm {

/// The digital lines of the safety chain, which the safety task reads and drives every millisecond.
///
/// Both calls are bounded by `kBudgetNs`, never allocate and never throw: real-time safe. Only the
/// safety thread calls them.
class SafetyLines {
 public:
  static constexpr std::int64_t kBudgetNs = 200'000;
  /// The hardware removes the enable when the charge pump has not toggled for this long.
  static constexpr std::int64_t kPumpTimeoutNs = 5'000'000;

  struct Outputs {
    bool relay_closed;  ///< false removes the drives' enable
    bool pump_level;    ///< charge pump: the drives are enabled only while this toggles
  };

  virtual ~SafetyLines() = default;

  /// Levels that held at `now_ns`, the task's due instant.
  virtual LineLevels Read(std::int64_t now_ns) noexcept = 0;

  /// Outputs that hold from `now_ns` on.
  virtual void Write(std::int64_t now_ns, const Outputs& outputs) noexcept = 0;
};

}  // namespace flexarm
