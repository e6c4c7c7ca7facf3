// The law `sobel` brings the tip to rest after the base command with light payloads too:
// rms of the tip about its mean in the last second of the 6 s experiment. `sobel-thesis` keeps link
// 2 in a limit cycle there: docs/theory/control-law.md 14.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/controller/loop/simulated_runs.h"
#include "tests/controller/loop/stack_run.h"

namespace flexarm {
namespace {

// Of every run with seeds 1 to 11: measured 0.61 to 0.90 (table of section 14.4).
constexpr double kAtRest_mm = 1.0;
constexpr double kMedian_mm = 0.75;  // measured 0.32 to 0.50

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

class SettlingLawWith : public testing::TestWithParam<double> {};

TEST_P(SettlingLawWith, LeavesTheTipAtRestInTheLastSecond) {
  const std::vector<double> motion_mm = LastSeconds_mm("sobel", GetParam(), kSeeds);
  EXPECT_LT(Largest(motion_mm), kAtRest_mm);
  EXPECT_LT(Median(motion_mm), kMedian_mm);
}

INSTANTIATE_TEST_SUITE_P(Payloads, SettlingLawWith, testing::Values(0.0, 0.01, 0.05, 0.1, 0.2),
                         [](const testing::TestParamInfo<double>& payload) {
                           return "Grams" + std::to_string(static_cast<int>(1e3 * payload.param));
                         });

// Friction holds the arm then. Compensated for ever, the shoulder's torque would follow each count
// of its encoder: 0.10 N m rms from sample to sample, measured without the hold; with it 0.003 and
// 0.004, 0.025 where a run is not held in the last seconds.
TEST(SettlingLaw, LeavesTheShoulderToItsFrictionAtRest) {
  Experiment long_rest = ShippedExperiment();
  long_rest.duration_s = 14.0;
  for (const double payload_kg : {0.0, 0.1, 0.2}) {
    StackRun run(ShippedRig(std::vector<std::string>{"controller.name=sobel"}), long_rest,
                 payload_kg);
    run.Run(15'000'000'000);
    double squares = 0.0;
    int count = 0;
    for (std::size_t k = 1; k < run.tick.size(); ++k) {
      const StepInput &before = run.tick[k - 1].input, &now = run.tick[k].input;
      if (now.safety_state != SafetyState::kRunning || now.now_ns < 10'000'000'000) continue;
      const double change_nm = now.applied_torque_nm[0] - before.applied_torque_nm[0];
      squares += change_nm * change_nm;
      ++count;
    }
    ASSERT_GT(count, 150);
    EXPECT_LT(std::sqrt(squares / count), 0.04) << payload_kg;
  }
}

// The limit cycle of section 14.1: measured 5 to 8 mm.
TEST(SettlingLaw, IsNeededWithoutPayload) {
  EXPECT_GT(Median(LastSeconds_mm("sobel-thesis", 0.0, 3)), 4.0 * kAtRest_mm);
}

}  // namespace
}  // namespace flexarm
