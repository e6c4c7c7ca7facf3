// How far the arm turns after a trip (docs/safety.md, "Stop categories"): damped by FaultStopping,
// and, with safety.fault_stop_s = 0, coasting. The plant carries a payload of which the design does
// not know, so the arm leaves its planned path and meets its limits while it moves.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/units.h"
#include "tests/controller/loop/stack_run.h"

namespace flexarm {
namespace {

struct Excursion {
  TripCause cause;
  std::array<double, 2> deg;  ///< largest distance of the hubs from where they were at the cause
  std::int64_t damped_ns;     ///< time in FaultStopping
};

Excursion ExcursionOf(RigConfig config, double fault_stop_s, double payload_kg) {
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

TEST(Excursion, DampingStopsTheElbowThatWouldCoast) {
  RigConfig soft = ShippedRig();
  soft.safety.soft_angle_deg[1] = 30.6;
  RigConfig fast = ShippedRig();
  fast.safety.hub_rate_rad_s[1] = 2.6;
  for (const RigConfig& config : {soft, fast}) {
    const Excursion coasts = ExcursionOf(config, 0.0, 0.2);
    const Excursion damped = ExcursionOf(config, 0.5, 0.2);
    SCOPED_TRACE(ToString(coasts.cause));
    EXPECT_EQ(coasts.cause, damped.cause);
    EXPECT_NE(coasts.cause, TripCause::kNone);
    EXPECT_EQ(coasts.damped_ns, 0);
    EXPECT_GT(damped.damped_ns, 400'000'000);
    EXPECT_LE(damped.damped_ns, 501'000'000);
    const double far_deg = std::max(coasts.deg[0], coasts.deg[1]);
    EXPECT_GT(far_deg, 60.0) << "it must coast, or there is nothing to show";
    EXPECT_LT(std::max(damped.deg[0], damped.deg[1]), 0.5 * far_deg);
  }
}

// The torque before the cause acts to the end of its period: damping torque is computed for the
// instant at which that ends, unlike the zero of category 0, which acts at once.
TEST(Excursion, DampingTorqueActsAtItsSamplingInstant) {
  RigConfig config = ShippedRig();
  config.safety.soft_angle_deg[1] = 30.6;  // lasts, unlike a rate: several steps with a fault
  StackRun run(config, ShippedExperiment(), 0.2);
  run.Run(8'000'000'000);
  const auto seen = std::find_if(run.tick.begin(), run.tick.end(),
                                 [](const TickRecord& tick) { return tick.output.faults != 0; });
  ASSERT_NE(seen, run.tick.end());
  ASSERT_EQ(seen->input.safety_state, SafetyState::kRunning);
  for (auto tick = seen; tick != seen + 4; ++tick) {
    EXPECT_NE(tick->output.faults, 0u);
    for (std::size_t i = 0; i < 2; ++i) {  // round-off of a mean over 20 slices
      EXPECT_NEAR((tick + 1)->input.applied_torque_nm[i], (tick - 1)->output.torque_nm[i], 1e-12);
    }
  }
  EXPECT_NE((seen + 1)->output.torque_nm, seen->output.torque_nm);
}

}  // namespace
}  // namespace flexarm
