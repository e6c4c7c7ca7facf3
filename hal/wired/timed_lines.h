#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/safety_lines.h"

namespace flexarm {

/// Lines whose every call is timed on the clock of the wall, so that the safety task gets the time
/// as data and reads no clock. Real-time: as the lines, and two readings of the clock a call.
class TimedLines final : public SafetyLines {
 public:
  /// @param monotonic_ns  as BusClocks::monotonic_ns
  TimedLines(std::unique_ptr<SafetyLines> lines, std::int64_t (*monotonic_ns)() noexcept)
      : lines_(std::move(lines)), monotonic_ns_(monotonic_ns) {}

  Reading Read(std::int64_t now_ns) noexcept override;
  Call Write(std::int64_t now_ns, const Outputs& outputs) noexcept override;
  void HoldOff() noexcept override { lines_->HoldOff(); }

 private:
  std::unique_ptr<SafetyLines> lines_;
  std::int64_t (*monotonic_ns_)() noexcept;
};

/// Reads the lines and writes them, relay open and pump still, some times: refuses lines that fail
/// once, or whose usual call takes longer than SafetyLines::kBudgetNs. The usual call is the
/// median: an interrupt in one of them says nothing of the chip. Not real-time.
/// @param chip  for the message
/// @throws HalError naming chip, call, its time and the budget
void RequireQuickLines(SafetyLines* lines, const std::string& chip);

}  // namespace flexarm
