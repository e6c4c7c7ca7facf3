// The law `sobel-settling` brings the tip to rest after the base command with light payloads too:
// rms of the tip about its mean in the last second of the 6 s experiment,
// docs/theory/control-law.md
// 14. `sobel` keeps link 2 in a limit cycle there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/controller/loop/simulated_runs.h"

namespace flexarm {
namespace {

// Wanted of every run; single runs stray to 1.08 mm at 0.2 kg (table of section 14.4), as in the
// acceptance limits of bars_test.cpp.
constexpr double kAtRest_mm = 1.0, kStrayFactor = 1.3;
constexpr double kMedian_mm = 0.75;  // measured 0.31 to 0.57

std::vector<double> LastSeconds_mm(const std::string& law, double payload_kg, int seeds) {
  std::vector<double> motion_mm;
  for (int seed = 1; seed <= seeds; ++seed) {
    const SimulationResult run =
        Run(payload_kg, static_cast<std::uint64_t>(seed), {"controller.name=" + law});
    EXPECT_TRUE(run.completed);
    motion_mm.push_back(run.metrics.tip_last_second_rms_mm);
  }
  std::printf("%s, %.2f kg: median %.2f, largest %.2f mm\n", law.c_str(), payload_kg,
              Median(motion_mm), Largest(motion_mm));
  return motion_mm;
}

class SettlingLaw : public testing::TestWithParam<double> {};

TEST_P(SettlingLaw, LeavesTheTipAtRestInTheLastSecond) {
  const std::vector<double> motion_mm = LastSeconds_mm("sobel-settling", GetParam(), kSeeds);
  EXPECT_LT(Largest(motion_mm), kStrayFactor * kAtRest_mm);
  EXPECT_LT(Median(motion_mm), kMedian_mm);
  EXPECT_LE(
      std::count_if(motion_mm.begin(), motion_mm.end(), [](double mm) { return mm >= kAtRest_mm; }),
      2);
}

INSTANTIATE_TEST_SUITE_P(Payloads, SettlingLaw, testing::Values(0.0, 0.01, 0.05, 0.1, 0.2),
                         [](const testing::TestParamInfo<double>& payload) {
                           return "Grams" + std::to_string(static_cast<int>(1e3 * payload.param));
                         });

// The limit cycle of section 14.1: measured 5 to 8 mm.
TEST(SettlingLawAlternative, IsNeededWithoutPayload) {
  EXPECT_GT(Median(LastSeconds_mm("sobel", 0.0, 3)), 4.0 * kAtRest_mm);
}

}  // namespace
}  // namespace flexarm
