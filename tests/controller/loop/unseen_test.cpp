// Cases that were not used for tuning, compared with those that were: the base command with 0.01,
// 0.1 and 0.2 kg and seeds 1 to 11. The acceptance limit is 20 %.
//
// Measured, rms of joints 1 and 2: with seeds 101 to 111 within 2 % of those of 1 to 11; 0.83 0.52
// deg at 0.05 kg and 0.79 1.87 at 0.15 kg, against 1.08 1.09 and 0.94 2.66 of the payloads around
// them; 25/-20 deg and 20/35 deg, scaled to 30 deg, 0.64 0.50 and 0.45 0.81 against 0.75 1.09.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tests/controller/loop/simulated_runs.h"

namespace flexarm {
namespace {

constexpr double kBar = 1.2;

std::array<double, 2> Rms(double payload_kg, std::uint64_t first_seed, const Experiment& command) {
  Runs runs;
  for (std::uint64_t seed = first_seed; seed < first_seed + kSeeds; ++seed) {
    Add(Simulate({.config = ShippedRig({"sim.seed=" + std::to_string(seed)}),
                  .experiment = command,
                  .payload_kg = payload_kg,
                  .log = {}}),
        &runs);
  }
  EXPECT_EQ(runs.tripped, 0);
  return {Median(runs.rms1_deg), Median(runs.rms2_deg)};
}

Experiment Turning(std::array<double, 2> by_deg) {
  Experiment command = ShippedExperiment();
  command.doublet[0].move_deg = by_deg;
  command.doublet[1].move_deg = {-by_deg[0], -by_deg[1]};
  return command;
}

void ExpectWithin(const char* what, const std::array<double, 2>& unseen,
                  const std::array<double, 2>& seen) {
  std::printf("  %-22s %.3f %.3f, tuned on %.3f %.3f\n", what, unseen[0], unseen[1], seen[0],
              seen[1]);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LE(unseen[i], kBar * seen[i]) << what;
}

TEST(Unseen, SeedsNotUsedForTuningGiveTheSame) {
  for (const double payload_kg : {0.01, 0.1, 0.2}) {
    const auto seen = Rms(payload_kg, 1, ShippedExperiment()),
               unseen = Rms(payload_kg, 101, ShippedExperiment());
    ExpectWithin("seeds 101 to 111", unseen, seen);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(unseen[i] / seen[i], 1.0, 0.2);
  }
}

// Between two payloads that were tuned on, no worse than the worse of them.
TEST(Unseen, PayloadsBetweenThoseUsedForTuningAreNoWorse) {
  struct Between {
    double payload_kg, lighter_kg, heavier_kg;
  };
  for (const Between& b : {Between{0.05, 0.01, 0.1}, Between{0.15, 0.1, 0.2}}) {
    const auto lighter = Rms(b.lighter_kg, 1, ShippedExperiment()),
               heavier = Rms(b.heavier_kg, 1, ShippedExperiment());
    ExpectWithin(b.payload_kg < 0.1 ? "0.05 kg" : "0.15 kg",
                 Rms(b.payload_kg, 101, ShippedExperiment()),
                 {std::max(lighter[0], heavier[0]), std::max(lighter[1], heavier[1])});
  }
}

// Another command bends the links less or more; its error is scaled by the angle of the move.
TEST(Unseen, AnotherCommandTracksAsWellForItsSize) {
  const auto seen = Rms(0.1, 1, ShippedExperiment());
  for (const std::array<double, 2> by_deg : {std::array{25.0, -20.0}, std::array{20.0, 35.0}}) {
    const double size = std::max(std::abs(by_deg[0]), std::abs(by_deg[1])) / 30.0;
    const auto unseen = Rms(0.1, 101, Turning(by_deg));
    ExpectWithin("another command", {unseen[0] / size, unseen[1] / size}, seen);
  }
}

}  // namespace
}  // namespace flexarm
