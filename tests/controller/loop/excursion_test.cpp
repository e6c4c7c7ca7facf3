// How far the arm turns after a trip (docs/safety.md, "Stop categories"): damped by FaultStopping,
// and, with safety.fault_stop_s = 0, coasting. The plant carries a payload of which the design does
// not know, so the arm leaves its planned path and meets its limits while it moves.

#include "tests/controller/loop/excursion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace flexarm {
namespace {

struct ExcursionRow {
  TripCause cause;
  double limit;  ///< deg, or rad/s if the cause is a hub rate
  double payload_kg;
  std::array<double, 3> far_deg;  ///< coasting, damped for 0.5 s, damped for 1.5 s
};

RigConfig RigWithLimitOf(const ExcursionRow& row) {
  RigConfig config = ShippedRig();
  if (row.cause == TripCause::kSoftLimit1) {
    config.safety.soft_angle_deg[0] = row.limit;
  } else if (row.cause == TripCause::kSoftLimit2) {
    config.safety.soft_angle_deg[1] = row.limit;
  } else {
    config.safety.hub_rate_rad_s[1] = row.limit;
  }
  return config;
}

// The rows of the table of docs/safety.md, as they were measured with this test. A degree is the
// rounding there, and what the libm of another distribution changes.
TEST(Excursion, IsAsFarAsTheSafetyPageSays) {
  constexpr std::array<double, 3> kFaultStop_s = {0.0, 0.5, 1.5};
  constexpr ExcursionRow kRows[] = {
      {TripCause::kSoftLimit1, 30.4, 0.0, {2, 1, 1}},
      {TripCause::kSoftLimit1, 30.4, 0.2, {85, 12, 4}},
      {TripCause::kSoftLimit2, 30.6, 0.2, {77, 22, 4}},
      {TripCause::kHubRate2, 2.6, 0.2, {356, 124, 26}},
      {TripCause::kSoftLimit2, 30.6, 0.5, {144, 65, 17}},
      {TripCause::kSoftLimit1, 30.4, 0.5, {57, 77, 4}},
      {TripCause::kHubRate2, 3.3, 0.9, {126, 99, 61}},
      {TripCause::kHubRate2, 2.7, 0.9, {244, 244, 244}},
  };
  for (const ExcursionRow& row : kRows) {
    for (std::size_t i = 0; i < kFaultStop_s.size(); ++i) {
      SCOPED_TRACE(std::string(ToString(row.cause)) + ", " + std::to_string(row.payload_kg) +
                   " kg, fault_stop_s " + std::to_string(kFaultStop_s[i]));
      const Excursion moved = ExcursionOf(RigWithLimitOf(row), kFaultStop_s[i], row.payload_kg);
      EXPECT_EQ(moved.cause, row.cause);
      EXPECT_LE(moved.damped_ns, std::llround(kFaultStop_s[i] * 1e9) + 1'000'000);
      EXPECT_NEAR(std::max(moved.deg[0], moved.deg[1]), row.far_deg[i], 1.0);
    }
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
