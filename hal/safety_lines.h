#pragma once

#include <cstdint>

#include "hal/sensor_frame.h"

namespace flexarm {

/// What the mirror contact of the relay says of the relay's main contacts.
enum class RelayContact : std::uint8_t {
  kNone,    ///< there is no such line
  kOpen,    ///< the mirror contact is closed: the main contacts are open for certain
  kClosed,  ///< or welded, or the wire of the mirror contact is cut
};

/// The digital lines of the safety chain, which the safety task reads and drives every millisecond.
///
/// A call takes `kBudgetNs` at most, never allocates and never throws: real-time safe. It says
/// whether it succeeded and how long it took; the safety monitor judges both
/// (controller/safety/line_calls.h). Only the safety thread calls.
class SafetyLines {
 public:
  static constexpr std::int64_t kBudgetNs = 200'000;
  /// The hardware removes the enable when the charge pump has not toggled for this long.
  static constexpr std::int64_t kPumpTimeoutNs = 5'000'000;

  struct Outputs {
    bool relay_closed;  ///< false removes the drives' enable
    bool pump_level;    ///< charge pump: the drives are enabled only while this toggles
  };

  /// How one call went.
  struct [[nodiscard]] Call {
    bool ok = true;            ///< false: the lines could not be read or set
    std::int64_t took_ns = 0;  ///< 0: lines inside the process, which answer at once
  };

  struct Reading {
    LineLevels levels;  ///< 0, every switch open, if the call failed
    Call call{};
    RelayContact relay = RelayContact::kNone;
  };

  virtual ~SafetyLines() = default;

  /// Levels that held at `now_ns`, the task's due instant.
  virtual Reading Read(std::int64_t now_ns) noexcept = 0;

  /// Outputs that hold from `now_ns` on.
  virtual Call Write(std::int64_t now_ns, const Outputs& outputs) noexcept = 0;

  /// Both outputs off for good: no later Write switches one on, and one that is under way in
  /// another thread is undone by a second call. For a process that is about to end. The only call
  /// that any thread may make, also from a signal handler: no lock, no heap.
  virtual void HoldOff() noexcept = 0;
};

}  // namespace flexarm
