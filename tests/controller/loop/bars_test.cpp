// The acceptance limits (bars) that the design study set for this rig: base command, alpha 3, full
// sensor chain, one sample of delay. A bar is met by the median over seeds 1 to 11 with no seed
// over 1.3 times it: single runs scatter (stiction, noise), a real change moves the median.
//
// Measured, median (largest) over the seeds:
//   payload           rms th1       rms th2       final th1, th2       settling     residual mm
//   sobel, 0.01 kg    1.07 (1.08)   0.69 (0.71)   0.02, 0.06 (0.08)    0.42 (0.44)  0.3 (0.4)
//   0.1 kg            0.73 (0.74)   1.09 (1.09)   0.02, 0.02 (0.04)    0.46 (0.48)  0.2 (0.6)
//   0.2 kg            0.94 (0.94)   2.69 (2.69)   0.03, 0.02 (0.05)    0.76 (0.76)  0.3 (0.4)
//   0, 0.5 and 1 kg: rms th1 1.16, 1.93, 2.42; rms th2 0.84, 7.09, 10.84
//   sobel-thesis,
//   0.01 kg           1.08 (1.09)   0.71 (0.72)   0.07, 0.05 (0.19)    0.62 (1.60)  4.2 (7.3)
//   0.1 kg            0.75 (0.77)   1.09 (1.10)   0.09, 0.16 (0.27)    1.02 (1.18)  2.5 (3.1)
//   0.2 kg            0.94 (0.94)   2.66 (2.67)   0.05, 0.11 (0.17)    0.76 (1.06)  2.6 (3.4)
//   0, 0.5 and 1 kg: rms th1 1.19, 1.79, 2.42; rms th2 0.86, 7.02, 10.84
// The bars were set for the thesis's kinematics; the arm with foreshortening must meet them too,
// with the same gains. Its medians, and why they differ: docs/stiffened-arm.md.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <tuple>

#include "tests/controller/loop/simulated_runs.h"

namespace flexarm {
namespace {

constexpr double kStray = 1.3;

struct Bars {
  double payload_kg;
  double rms1_deg, rms2_deg, final_deg, settling_s, residual_mm, peak1_nm, peak2_nm;
};

void ExpectMet(const char* what, const std::vector<double>& values, double bar) {
  std::printf("  %-12s median %7.3f  largest %7.3f  bar %6.2f\n", what, Median(values),
              Largest(values), bar);
  EXPECT_LE(Median(values), bar) << what;
  EXPECT_LE(Largest(values), kStray * bar) << what;
}

// What the bars hold for.
struct Loop {
  const char* name;
  const char* override;
};
constexpr Loop kLoops[] = {{"Shipped", "arm.foreshortening=false"},
                           {"Stiffened", "arm.foreshortening=true"},
                           {"ThesisLaw", kThesisLaw}};

Runs RunsOf(double payload_kg, const Loop& loop) {
  std::printf("payload %.2f kg, %s\n", payload_kg, loop.name);
  return RunSeeds(payload_kg, {loop.override});
}

std::string NameOf(double payload_kg, const Loop& loop) {
  return "Grams" + std::to_string(std::lround(1e3 * payload_kg)) + loop.name;
}

class ClosedLoopBars : public testing::TestWithParam<std::tuple<Bars, Loop>> {};

TEST_P(ClosedLoopBars, AreMetByTheMedianAndWithinThirtyPercentByEverySeed) {
  const auto& [bars, loop] = GetParam();
  const Runs runs = RunsOf(bars.payload_kg, loop);
  EXPECT_EQ(runs.tripped, 0);
  ExpectMet("rms th1", runs.rms1_deg, bars.rms1_deg);
  ExpectMet("rms th2", runs.rms2_deg, bars.rms2_deg);
  ExpectMet("final th1", runs.final1_deg, bars.final_deg);
  ExpectMet("final th2", runs.final2_deg, bars.final_deg);
  ExpectMet("settling", runs.settling_s, bars.settling_s);
  ExpectMet("residual", runs.residual_mm, bars.residual_mm);
  ExpectMet("peak u1", runs.peak1_nm, bars.peak1_nm);
  ExpectMet("peak u2", runs.peak2_nm, bars.peak2_nm);
}

constexpr Bars kBars[] = {{.payload_kg = 0.01,
                           .rms1_deg = 1.25,
                           .rms2_deg = 0.85,
                           .final_deg = 0.35,
                           .settling_s = 1.7,
                           .residual_mm = 6.0,
                           .peak1_nm = 10.0,
                           .peak2_nm = 2.2},
                          {.payload_kg = 0.1,
                           .rms1_deg = 0.90,
                           .rms2_deg = 1.35,
                           .final_deg = 0.35,
                           .settling_s = 1.3,
                           .residual_mm = 6.0,
                           .peak1_nm = 9.0,
                           .peak2_nm = 2.2},
                          {.payload_kg = 0.2,
                           .rms1_deg = 1.10,
                           .rms2_deg = 3.0,
                           .final_deg = 0.35,
                           .settling_s = 1.2,
                           .residual_mm = 6.0,
                           .peak1_nm = 10.0,
                           .peak2_nm = 2.2}};

INSTANTIATE_TEST_SUITE_P(Payloads, ClosedLoopBars,
                         testing::Combine(testing::ValuesIn(kBars), testing::ValuesIn(kLoops)),
                         [](const auto& shown) {
                           return NameOf(std::get<0>(shown.param).payload_kg,
                                         std::get<1>(shown.param));
                         });

struct StableBars {
  double payload_kg, rms1_deg, rms2_deg;
};

class FarPayload : public testing::TestWithParam<std::tuple<StableBars, Loop>> {};

// Five and ten times the design's payload, and none: stable, and within the design study's
// bars.
TEST_P(FarPayload, IsCarriedToTheEndWithoutATrip) {
  const auto& [bars, loop] = GetParam();
  const Runs runs = RunsOf(bars.payload_kg, loop);
  EXPECT_EQ(runs.tripped, 0);
  ExpectMet("rms th1", runs.rms1_deg, bars.rms1_deg);
  ExpectMet("rms th2", runs.rms2_deg, bars.rms2_deg);
}

constexpr StableBars kFarBars[] = {{0.0, 1.4, 1.0}, {0.5, 2.0, 7.5}, {1.0, 2.8, 11.5}};

INSTANTIATE_TEST_SUITE_P(Payloads, FarPayload,
                         testing::Combine(testing::ValuesIn(kFarBars), testing::ValuesIn(kLoops)),
                         [](const auto& shown) {
                           return NameOf(std::get<0>(shown.param).payload_kg,
                                         std::get<1>(shown.param));
                         });

}  // namespace
}  // namespace flexarm
