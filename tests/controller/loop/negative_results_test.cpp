// What does not work in the design study must not work here either: a loop that survives these
// cases is another loop than the one studied.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/controller/loop/simulated_runs.h"

namespace flexarm {
namespace {

int Failures(const Runs& runs, double bar1_deg, double bar2_deg) {
  int failures = 0;
  for (std::size_t i = 0; i < runs.rms1_deg.size(); ++i) {
    const bool worse = runs.rms1_deg[i] > 2.0 * bar1_deg || runs.rms2_deg[i] > 2.0 * bar2_deg;
    if (runs.trip[i] != TripCause::kNone || worse) ++failures;
    std::printf("  rms %7.2f %7.2f  %s\n", runs.rms1_deg[i], runs.rms2_deg[i],
                ToString(runs.trip[i]));
  }
  return failures;
}

// One sample of delay without prediction: at 0.01 kg every seed diverges, that is trips or at
// least doubles its rms. (Study: 5 of 12 trip, the others end at 16 and 13 deg; here
// all 11 trip on the bending of link 1, rms 3.4 and 2.1 deg until then.)
TEST(NegativeResults, WithoutPredictionTheLightArmDiverges) {
  const Runs with = RunSeeds(0.01);
  const Runs without = RunSeeds(0.01, {"controller.prediction=false"});
  EXPECT_EQ(Failures(without, Median(with.rms1_deg), Median(with.rms2_deg)), kSeeds);
}

// Study: 0.1 and 0.2 kg are fine without prediction. So the failure above is that of the delay.
TEST(NegativeResults, WithoutPredictionTheNominalArmIsStable) {
  for (const double payload_kg : {0.1, 0.2}) {
    EXPECT_EQ(RunSeeds(payload_kg, {"controller.prediction=false"}, 3).tripped, 0) << payload_kg;
  }
}

// The thesis's differences behind the thesis's 20 Hz gauge filter: unstable at alpha 3 (design
// study: 0 of 8 survive). Here every run trips on the bending of link 1.
TEST(NegativeResults, DifferencesBehindTheGaugeFilterTripAtEveryPayload) {
  for (const double payload_kg : {0.01, 0.1, 0.2}) {
    const Runs runs = RunSeeds(payload_kg, {"estimator.name=difference"}, 3);
    EXPECT_EQ(Failures(runs, 1e9, 1e9), 3) << payload_kg;
  }
}

// Without the filter they work at alpha 2: design study, rms 1.0 to 1.6 and 1.2 to 2.9 deg. The
// bars are those figures with a third of room. Measured: 1.53 1.09, 0.99 1.59, 1.15 2.79.
TEST(NegativeResults, DifferencesWithoutTheGaugeFilterWorkAtAlphaTwo) {
  struct Bar {
    double payload_kg, rms1_deg, rms2_deg;
  };
  for (const Bar& bar : {Bar{0.01, 1.55, 1.21}, Bar{0.1, 1.04, 1.69}, Bar{0.2, 1.13, 2.83}}) {
    const Runs runs = RunSeeds(
        bar.payload_kg,
        {"estimator.name=difference", "sensors.strain_input.filter_hz=0.0", "controller.alpha=2.0"},
        3);
    std::printf("payload %.2f kg\n", bar.payload_kg);
    EXPECT_EQ(Failures(runs, 1e9, 1e9), 0);
    EXPECT_LE(Median(runs.rms1_deg), 1.33 * bar.rms1_deg);
    EXPECT_LE(Median(runs.rms2_deg), 1.33 * bar.rms2_deg);
  }
}

// Study: alpha 5 is unstable in the full chain, or rms rises by half, for some payload. Here rms
// rises by 55 % at 0.01 kg and falls at 0.2 kg; no trip.
TEST(NegativeResults, AlphaFiveFailsForSomePayload) {
  bool failed = false;
  for (const double payload_kg : {0.01, 0.1, 0.2}) {
    const Runs three = RunSeeds(payload_kg, {}, 3),
               five = RunSeeds(payload_kg, {"controller.alpha=5.0"}, 3);
    std::printf("payload %.2f kg: rms %.2f %.2f -> %.2f %.2f, %d trips\n", payload_kg,
                Median(three.rms1_deg), Median(three.rms2_deg), Median(five.rms1_deg),
                Median(five.rms2_deg), five.tripped);
    failed = failed || five.tripped > 0 || Median(five.rms1_deg) > 1.5 * Median(three.rms1_deg) ||
             Median(five.rms2_deg) > 1.5 * Median(three.rms2_deg);
  }
  EXPECT_TRUE(failed);
}

}  // namespace
}  // namespace flexarm
