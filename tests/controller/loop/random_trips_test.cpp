// Why safety.fault_stop_s is 1.5 s: how far the arm turns after random trips (docs/safety.md,
// "Stop categories").

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <random>
#include <vector>

#include "controller/step/fault_detection.h"
#include "tests/controller/loop/excursion.h"

namespace flexarm {
namespace {

// One limit is between what the planned path needs, so that the run is not refused, and a bit more,
// so that an arm with a payload meets it.
RigConfig RandomLimit(std::mt19937_64* random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  RigConfig config = ShippedRig();
  const std::size_t joint = share(*random) < 0.5 ? 0 : 1;
  if (share(*random) < 0.3) {
    const double needed_rad_s = joint == 0 ? 2.31 : 2.62;
    config.safety.hub_rate_rad_s[joint] = needed_rad_s + 1.5 * share(*random);
  } else {
    config.safety.soft_angle_deg[joint] = 30.1 + 2.3 * share(*random);
  }
  return config;
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

TEST(RandomTrips, TurnTheArmLeastIfItIsDampedUntilItRests) {
  constexpr std::array<double, 5> kFaultStop_s = {0.0, 0.5, 1.0, 1.5, 2.0};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> payload_kg(0.0, 0.6);
  std::array<std::vector<double>, kFaultStop_s.size()> far_deg;
  while (far_deg[0].size() < 60) {
    const RigConfig config = RandomLimit(&random);
    const double kg = payload_kg(random);
    for (std::size_t i = 0; i < kFaultStop_s.size(); ++i) {
      const Excursion moved = ExcursionOf(config, kFaultStop_s[i], kg);
      if (moved.cause == TripCause::kNone) break;  // it stays within the limit
      far_deg[i].push_back(std::max(moved.deg[0], moved.deg[1]));
    }
  }
  std::array<double, kFaultStop_s.size()> median{}, most{};
  for (std::size_t i = 0; i < kFaultStop_s.size(); ++i) {
    median[i] = Median(far_deg[i]);
    most[i] = *std::max_element(far_deg[i].begin(), far_deg[i].end());
    std::printf("fault_stop_s %.1f: median %.0f deg, most %.0f deg\n", kFaultStop_s[i], median[i],
                most[i]);
  }
  // Shares of what coasting gives, twice those measured.
  EXPECT_LT(median[1], 0.35 * median[0]);
  EXPECT_LT(median[3], 0.11 * median[0]);
  EXPECT_LT(most[3], 0.2 * most[0]);
  EXPECT_LE(most[3], most[2]);
  EXPECT_LT(most[3], FaultDetection::kDampedBeyond_deg) << "damping that works is not cut";
}

}  // namespace
}  // namespace flexarm
