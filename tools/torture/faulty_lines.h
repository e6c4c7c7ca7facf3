#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "controller/tasks/simulated_lines.h"
#include "hal/safety_lines.h"
#include "tools/torture/fault.h"

namespace flexarm {

/// The lines of the simulated rig with faults: of the inputs, of the calls, of relay and pump.
class FaultyLines final : public SafetyLines {
 public:
  FaultyLines(SafetyLines* lines, const std::vector<Fault>& faults);

  Reading Read(std::int64_t now_ns) noexcept override;
  Call Write(std::int64_t now_ns, const Outputs& outputs) noexcept override;
  void HoldOff() noexcept override { lines_->HoldOff(); }

  /// What the safety task told the lines last.
  const Outputs& told() const noexcept { return told_; }

 private:
  bool CallFails(FaultPlace place, std::int64_t now_ns, Call* call) noexcept;
  LineLevels Spoilt(const Fault& fault, LineLevels levels) noexcept;

  SafetyLines* lines_;
  const std::vector<Fault>* faults_;
  std::mt19937_64 random_{1};
  Outputs told_{.relay_closed = false, .pump_level = false};
  Outputs put_out_{.relay_closed = false, .pump_level = false};
  Outputs before_{.relay_closed = false, .pump_level = false};  // told a tick before
  std::vector<LineLevels> held_;  // by fault: the levels of the tick before it
  LineLevels levels_before_ = kHealthyLevels;
};

}  // namespace flexarm
