#pragma once

#include <cstdint>

#include "controller/safety/windowed_count.h"
#include "controller/types/messages.h"
#include "controller/types/trip_cause.h"
#include "hal/safety_lines.h"

namespace flexarm {

/// The newest calls of the lines of the safety chain in a tick: this tick's read, and the write of
/// the tick before.
struct LineCalls {
  SafetyLines::Call read{};
  SafetyLines::Call write{};
};

/// Judges whether the lines can be relied upon: the cause `safety-lines`.
///
/// - A call that fails counts at once: the kernel has lost the chip.
/// - A call that takes longer than `stall_ns`, the time-out of the permit, counts at once: relay
///   and charge pump stood still for so long.
/// - A tick with a call over SafetyLines::kBudgetNs counts when it is the 4th of the last 32. The
///   time on the wall contains that of an interrupt or of another thread: one such tick says
///   nothing of the chip. A chip whose every call sleeps shows it in 4 ms, one that sleeps in every
///   8th in 25 ms.
///
/// Pure, without a clock: the lines measure their calls. Real-time: safe.
class LineCallMonitor {
 public:
  static constexpr int kSlowTicks = 4;
  static constexpr int kWindowTicks = 32;

  explicit constexpr LineCallMonitor(std::int64_t stall_ns) noexcept : stall_ns_(stall_ns) {}

  /// Once per tick. @returns true while the lines cannot be relied upon
  constexpr bool Judge(const LineCalls& calls) noexcept {
    const std::int64_t longest_ns = Longest(calls).took_ns;
    slow_.Push(longest_ns > SafetyLines::kBudgetNs);
    return !calls.read.ok || !calls.write.ok || longest_ns > stall_ns_ ||
           slow_.count() >= kSlowTicks;
  }

  /// The call that failed, else the longest: its time and the budget in s, and a LineTrouble.
  static constexpr Evidence EvidenceOf(const LineCalls& calls) noexcept {
    const bool failed = !calls.read.ok || !calls.write.ok;
    const bool write = failed ? calls.read.ok : calls.write.took_ns > calls.read.took_ns;
    const SafetyLines::Call& call = write ? calls.write : calls.read;
    const LineTrouble named = write ? (failed ? LineTrouble::kWriteFailed : LineTrouble::kWriteSlow)
                                    : (failed ? LineTrouble::kReadFailed : LineTrouble::kReadSlow);
    return {.value = static_cast<double>(call.took_ns) * 1e-9,
            .limit = static_cast<double>(SafetyLines::kBudgetNs) * 1e-9,
            .channel = static_cast<std::uint32_t>(named),
            .detail = 0};
  }

 private:
  static constexpr const SafetyLines::Call& Longest(const LineCalls& calls) noexcept {
    return calls.write.took_ns > calls.read.took_ns ? calls.write : calls.read;
  }

  std::int64_t stall_ns_;
  WindowedCount slow_{kWindowTicks};
};

}  // namespace flexarm
