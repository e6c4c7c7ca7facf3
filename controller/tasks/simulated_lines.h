#pragma once

#include <atomic>
#include <cstdint>

#include "controller/exchange/history.h"
#include "controller/exchange/latest_value.h"
#include "hal/safety_lines.h"

namespace flexarm {

using LevelHistory = History<LineLevels, 24>;
using LevelChannel = LatestValue<LevelHistory>;
using OutputHistory = History<SafetyLines::Outputs, 24>;
using OutputChannel = LatestValue<OutputHistory>;

/// The safety chain of the simulated rig: channels to the plant task, which simulates the switches,
/// the relay and the charge pump. A call waits for nothing: it takes 0 ns and never fails.
class SimulatedLines final : public SafetyLines {
 public:
  SimulatedLines(LevelChannel* levels, OutputChannel* outputs)
      : levels_(levels), channel_(outputs) {}

  // A level published at this instant may not be visible yet: read the one before.
  Reading Read(std::int64_t now_ns) noexcept override {
    return {.levels = levels_->Read().At(now_ns - 1).value};
  }

  Call Write(std::int64_t now_ns, const Outputs& outputs) noexcept override {
    constexpr Outputs kOff{.relay_closed = false, .pump_level = false};
    history_.Push(now_ns, held_off_.load() ? kOff : outputs);
    channel_->PublishGrown(history_);
    return {};
  }

  /// The lines end with the process; until then every Write is off.
  void HoldOff() noexcept override { held_off_.store(true); }

 private:
  LevelChannel* levels_;
  OutputChannel* channel_;
  std::atomic<bool> held_off_{false};
  OutputHistory history_{Outputs{.relay_closed = false, .pump_level = false}};
};

}  // namespace flexarm
