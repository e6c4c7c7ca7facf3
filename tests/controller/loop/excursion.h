#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "model/units.h"
#include "tests/controller/loop/stack_run.h"

namespace flexarm {

/// How far an arm turns after a cause of a trip.
struct Excursion {
  TripCause cause;
  std::array<double, 2> deg;  ///< largest distance of the hubs from where they were at the cause
  std::int64_t damped_ns;     ///< time in FaultStopping
};

/// A square of 30 degrees with a payload of which the design does not know.
inline Excursion ExcursionOf(RigConfig config, double fault_stop_s, double payload_kg) {
  config.safety.fault_stop_s = fault_stop_s;
  StackRun run(config, ShippedExperiment(), payload_kg);
  run.Run(8'000'000'000);
  Excursion out{};
  std::int64_t latched_ns = INT64_MAX;
  for (const SafetyRecord& record : run.safety) {
    if (record.before.state == record.after.state) continue;
    if (CauseLatched(record.after.state) && latched_ns == INT64_MAX) {
      latched_ns = record.due_ns;
      out.cause = record.after.cause;
    }
    if (record.before.state == SafetyState::kFaultStopping) {
      out.damped_ns = record.due_ns - latched_ns;
    }
  }
  const TickRecord* at = nullptr;
  for (const TickRecord& tick : run.tick) {
    if (tick.input.sampling_instant_ns < latched_ns) at = &tick;
    if (at == nullptr || tick.input.sampling_instant_ns < latched_ns) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      const double moved = tick.output.angle_rad[i] - at->output.angle_rad[i];
      out.deg[i] = std::max(out.deg[i], std::fabs(moved) / kRadPerDeg);
    }
  }
  return out;
}

}  // namespace flexarm
