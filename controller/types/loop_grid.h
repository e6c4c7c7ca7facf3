#pragma once

#include <cmath>
#include <cstdint>

#include "controller/types/runtime_config.h"

namespace flexarm {

/// The control grid in nanoseconds, with the only conversion of instants to samples.
///
/// Sampling instant k is at k Ts; its step is due `phase` later and published by `deadline` after
/// that. Its torque is output `output_late` after (k+1) Ts (negative: before it) and acts
/// `actuation` later. The first step in state Running, k0, computes the torque for the experiment's
/// sample 0; so the experiment starts when that torque acts.
struct LoopGrid {
  std::int64_t period_ns;
  std::int64_t phase_ns;
  std::int64_t deadline_ns;
  std::int64_t output_late_ns;  ///< 0 for OutputTiming::kNextTick
  std::int64_t actuation_ns;

  explicit LoopGrid(const LoopConfig& loop)
      : period_ns(loop.period_ns()),
        phase_ns(std::llround(loop.acquire_before_ms * 1e6)),
        deadline_ns(std::llround(loop.step_deadline_ms * 1e6)),
        output_late_ns(loop.output == OutputTiming::kAtOnce
                           ? std::llround(loop.output_after_ms * 1e6) - period_ns
                           : 0),
        actuation_ns(std::llround(loop.actuation_delay_ms * 1e6)) {}

  std::int64_t Tick(std::int64_t due_ns) const { return (due_ns - phase_ns) / period_ns; }
  std::int64_t SamplingInstant(std::int64_t tick) const { return tick * period_ns; }
  /// From (k+1) Ts to the instant at which torque k acts.
  std::int64_t late_ns() const { return output_late_ns + actuation_ns; }
  double period_s() const { return static_cast<double>(period_ns) * 1e-9; }

  /// Start of the experiment whose run was granted at `running_since_ns`: a step reads the permit
  /// that was valid just before its due instant.
  std::int64_t ExperimentStart(std::int64_t running_since_ns) const {
    std::int64_t first = running_since_ns < phase_ns ? 0 : Tick(running_since_ns) + 1;
    return SamplingInstant(first + 1) + late_ns();
  }
};

}  // namespace flexarm
