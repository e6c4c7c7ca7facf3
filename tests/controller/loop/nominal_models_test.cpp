// The nominal models in the whole stack, over the base experiment: the figures of
// docs/nominal-models.md.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "tests/controller/loop/simulated_runs.h"

namespace flexarm {
namespace {

constexpr int kSeedsAtTheBorder = 12;
constexpr int kFewSeeds = 3;  // the differences here are far larger than those between seeds

Runs RunsWith(const std::string& nominal, double payload_kg,
              std::vector<std::string> overrides = {}, int seeds = kFewSeeds) {
  overrides.push_back("controller.nominal=" + nominal);
  Runs runs = RunSeeds(payload_kg, overrides, seeds);
  std::printf("%s %.2f kg: %d tripped, rms %.2f %.2f deg, residual %.1f mm\n", nominal.c_str(),
              payload_kg, runs.tripped, Median(runs.rms1_deg), Median(runs.rms2_deg),
              Median(runs.residual_mm));
  return runs;
}

// docs/theory/control-law.md 12.2: R12 and T16 perform alike, there rms 1.00/1.34 against 1.37/1.44
// deg. Here 0.75/1.10 against 0.79/0.78 at the design's payload: a third apart at most, as there.
TEST(T16, PerformsLikeR12) {
  for (const double payload_kg : {0.1, 0.2}) {
    const Runs r12 = RunsWith("R12", payload_kg), t16 = RunsWith("T16", payload_kg);
    EXPECT_EQ(r12.tripped + t16.tripped, 0);
    for (const auto& [a, b] : {std::pair{Median(r12.rms1_deg), Median(t16.rms1_deg)},
                               {Median(r12.rms2_deg), Median(t16.rms2_deg)}}) {
      EXPECT_NEAR(b, a, 0.35 * a) << payload_kg;
    }
  }
}

// Finding 2: T12 is fragile at alpha = 3, most with little payload, where it bends link 1 to its
// limit (2 of 3 runs; T16 1.24 deg). With 0.1 kg it completes, at nearly three times R12's
// error.
TEST(T12, AtAlphaThreeTripsWithLittlePayloadAndTracksItsOwnPoorly) {
  const Runs light = RunsWith("T12", 0.01);
  EXPECT_GE(light.tripped, 1);
  EXPECT_NE(std::count(light.trip.begin(), light.trip.end(), TripCause::kBendingStrain1), 0);
  EXPECT_EQ(RunsWith("T16", 0.01).tripped, 0);
  EXPECT_GT(Median(RunsWith("T12", 0.1).rms2_deg), 2.0 * Median(RunsWith("R12", 0.1).rms2_deg));
}

// Finding 4: T12 is best at alpha 1.5 .. 2.5, where it completes with payloads that trip it at 3.
TEST(T12, AtAlphaTwoCarriesEveryPayloadOfTheThesis) {
  for (const double payload_kg : {0.01, 0.1, 0.2}) {
    EXPECT_EQ(RunsWith("T12", payload_kg, {"controller.alpha=2.0"}).tripped, 0) << payload_kg;
  }
}

// Finding 2, T12*: with sensors and delay it survives alpha = 3 only behind a slow Kalman filter
// with little process noise: here every force on the links is a hundredth of the shipped filter's.
TEST(T12WithSearchedWeights, NeedsAFilterWithLittleProcessNoise) {
  const std::vector<std::string> searched = {
      "controller.torque_weight=4.5",
      "controller.state_weight=[28.5, 22, 0, 0, 0, 0.12, 0.28, 0.16, 0, 0, 14.8, 0]"};
  // Of 40 runs 17 trip, and the others swing on: residual 70 mm. Chance decides whether a run of a
  // loop at the border of stability trips: 2 of 12 or more do but once in 70 sets of seeds.
  const Runs fragile = RunsWith("T12", 0.01, searched, kSeedsAtTheBorder);
  EXPECT_GE(fragile.tripped, 2);
  EXPECT_GT(Median(fragile.residual_mm), 30.0);
  std::vector<std::string> trusting = searched;
  trusting.push_back("estimator.process_force=[0.1, 0.015, 0.05, 0.05, 0.015, 0.015]");
  const Runs runs = RunsWith("T12", 0.01, trusting);
  EXPECT_EQ(runs.tripped, 0);
  EXPECT_LT(Median(runs.rms1_deg), 1.1) << "the design study's figure";
  EXPECT_LT(Median(runs.rms2_deg), 3.0) << "the design study's figure";
}

// One mode a link without joint springs: fewer states, and worse with other payloads than designed.
// Without payload 9 of 40 runs trip by the rate of the elbow, which the jumps of the command reach:
// fewer than half of 12 but once in 40 sets of seeds.
TEST(R8, CarriesEveryPayloadAndMostlyNone) {
  for (const double payload_kg : {0.1, 1.0}) {
    EXPECT_EQ(RunsWith("R8", payload_kg).tripped, 0) << payload_kg;
  }
  const Runs empty = RunsWith("R8", 0.0, {}, kSeedsAtTheBorder);
  EXPECT_LT(empty.tripped, kSeedsAtTheBorder / 2);
  for (const TripCause cause : empty.trip) {
    EXPECT_TRUE(cause == TripCause::kNone || cause == TripCause::kHubRate2) << ToString(cause);
  }
}

}  // namespace
}  // namespace flexarm
