// The same loop with one thing changed: another law, plant, command or limit.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/controller/loop/simulated_runs.h"
#include "tools/sweep/plant_variant.h"

namespace flexarm {
namespace {

void Print(const char* what, const Runs& runs) {
  std::printf(
      "  %-24s rms %6.3f %6.3f  final %5.3f %5.3f  settling %5.2f  residual %5.2f  trips %d\n",
      what, Median(runs.rms1_deg), Median(runs.rms2_deg), Median(runs.final1_deg),
      Median(runs.final2_deg), Median(runs.settling_s), Median(runs.residual_mm), runs.tripped);
}

// The design study: 0.76 against 1.12 deg; measured 0.75 against 1.05. What is compared is the
// feedforward (7.24)-(7.25): the adaptation adds nothing at this payload.
TEST(LoopVariants, SobelTracksJointOneAQuarterBetterThanLqrWithCgt) {
  const Runs sobel = RunSeeds(0.1), lqr = RunSeeds(0.1, {"controller.name=lqr-cgt"});
  Print("sobel", sobel);
  Print("lqr-cgt", lqr);
  EXPECT_EQ(lqr.tripped, 0);
  EXPECT_LE(Median(sobel.rms1_deg), 0.75 * Median(lqr.rms1_deg));
}

// The baseline laws, at the payload of their design and next to it. The benchmark compares the
// laws; here each completes in the same loop, and tracks. Measured, rms th1 and th2 at 0.1 kg:
// sobel-original 0.76 1.00, lqg 5.3 3.7, pd 1.0 1.5 deg; lqr-um bends link 1 beyond its strain
// limit at 0.1 kg (a trip), and gives 2.0 3.1 at 0.2 kg.
TEST(LoopVariants, EveryLawRunsThroughTheSameLoop) {
  for (const char* law : {"sobel-original", "lqr-cgt", "lqr-um", "lqg", "pd"}) {
    const Runs runs = RunSeeds(0.2, {std::string("controller.name=") + law}, 3);
    Print(law, runs);
    EXPECT_EQ(runs.tripped, 0) << law;
    EXPECT_LT(Median(runs.rms1_deg), 10.0) << law;
    EXPECT_LT(Median(runs.rms2_deg), 10.0) << law;
  }
}

// The thesis's estimator, without the gauge filter that makes its differences unstable (alpha 2, as
// in the design study's table): the polynomial fit increases the rms by 3 %, measured.
TEST(LoopVariants, ThePolynomialFitTracksAsTheDirectOneDoes) {
  const auto runs = [](const char* estimator) {
    return RunSeeds(0.1, {std::string("estimator.name=") + estimator,
                          "sensors.strain_input.filter_hz=0", "controller.alpha=2"});
  };
  const Runs direct = runs("difference"), polynomial = runs("polynomial");
  Print("difference", direct);
  Print("polynomial", polynomial);
  EXPECT_EQ(polynomial.tripped, 0);
  EXPECT_NEAR(Median(polynomial.rms1_deg) / Median(direct.rms1_deg), 1.0, 0.1);
  EXPECT_NEAR(Median(polynomial.rms2_deg) / Median(direct.rms2_deg), 1.0, 0.1);
}

// The base moves with seven seconds of rest after each: a shaped move ends 2.4 (ZV) and 4.7 s (ZVD)
// later. Measured at 0.2 kg, rms th2 from the law's own reference: 4.2, 1.9 and 1.5 deg; peak
// torque of joint 1 7.2, 3.2 and 2.9 N m.
TEST(LoopVariants, ShapingTheReferenceReducesTheVibrationUnderPd) {
  Experiment slow = ShippedExperiment();
  slow.duration_s = 16.0;
  slow.doublet[1].start_s = 8.0;
  const auto rms2_deg = [&slow](const char* law) {
    const SimulationResult result =
        Simulate({.config = ShippedRig({std::string("controller.name=") + law}),
                  .experiment = slow,
                  .payload_kg = 0.2,
                  .log = {}});
    EXPECT_TRUE(result.completed) << law;
    return result.metrics.joint_rms_error_deg[1];
  };
  const double pd = rms2_deg("pd"), zv = rms2_deg("pd-zv"), zvd = rms2_deg("pd-zvd");
  std::printf("  rms th2: pd %.2f, pd-zv %.2f, pd-zvd %.2f deg\n", pd, zv, zvd);
  EXPECT_LT(zv, 0.6 * pd);
  EXPECT_LT(zvd, zv);
}

// The design study's bar: stable, rms 25 % up at most. Every tenth frame has no reading; the
// payload filter bridges it with its model. Measured, rms th1 and th2 with all frames and without a
// tenth: 1.07 0.69 and 1.06 0.75 at 0.01 kg, 0.73 1.09 and 0.74 1.11 at 0.1 kg, 0.94 2.69 and 0.98
// 2.69 at 0.2 kg. With the Kalman filter's model it is 1.10 0.87 at 0.01 kg, beyond the bar.
TEST(LoopVariants, OneFrameInTenMayBeLost) {
  for (const double payload_kg : {0.01, 0.1, 0.2}) {
    const Runs all = RunSeeds(payload_kg),
               lossy = RunSeeds(payload_kg, {"sim.lost_frame_fraction=0.1"});
    std::printf("payload %.2f kg\n", payload_kg);
    Print("all frames", all);
    Print("10 % lost", lossy);
    EXPECT_EQ(lossy.tripped, 0) << payload_kg;
    EXPECT_LE(Median(lossy.rms1_deg), 1.25 * Median(all.rms1_deg)) << payload_kg;
    EXPECT_LE(Median(lossy.rms2_deg), 1.25 * Median(all.rms2_deg)) << payload_kg;
    EXPECT_NE(lossy.rms1_deg, all.rms1_deg) << "no frame was lost: the test is inconclusive";
  }
}

// No bar: the design study found no benefit of the adaptation at 0 to 0.2 kg. Both must run, and
// must not be the same run. Measured, rms th1 and th2 with and without: 1.08 0.70 and 1.06 0.89 at
// 0.01 kg, 0.75 1.10 and 0.83 1.07 at 0.1 kg, 0.94 2.66 and 0.99 2.91 at 0.2 kg, 2.43 10.8 and 2.35
// 12.2 at 1 kg; final error of joint 2 at 1 kg 3.4 and 5.7 deg.
TEST(LoopVariants, RunsWithAndWithoutAdaptation) {
  for (const double payload_kg : {0.01, 0.1, 0.2, 1.0}) {
    const Runs with = RunSeeds(payload_kg, {}, 3),
               without = RunSeeds(payload_kg, {"controller.adaptation=false"}, 3);
    std::printf("payload %.2f kg\n", payload_kg);
    Print("adaptation", with);
    Print("no adaptation", without);
    EXPECT_EQ(without.tripped, 0);
    EXPECT_TRUE(std::isfinite(Median(without.rms1_deg) + Median(without.rms2_deg)));
    EXPECT_NE(without.rms2_deg, with.rms2_deg);
  }
}

// The loop with a controller of two modes a link must not depend on the plant's number of modes:
// rms within 5 % (the design study's bar) of the four-mode plant. Measured: within 0.6 %.
TEST(LoopVariants, RmsDoesNotDependOnThePlantsModes) {
  const Runs four = RunSeeds(0.1);
  Print("4 modes", four);
  for (const int modes : {2, 3, 6}) {
    const Runs runs = RunSeeds(0.1, {"sim.plant_modes=" + std::to_string(modes)});
    Print((std::to_string(modes) + " modes").c_str(), runs);
    EXPECT_EQ(runs.tripped, 0);
    EXPECT_NEAR(Median(runs.rms1_deg) / Median(four.rms1_deg), 1.0, 0.05) << modes;
    EXPECT_NEAR(Median(runs.rms2_deg) / Median(four.rms2_deg), 1.0, 0.05) << modes;
  }
}

TEST(LoopVariants, TheOtherShippedExperimentsComplete) {
  for (const char* experiment : {"sine", "square-20deg"}) {
    for (const double payload_kg : {0.01, 0.1, 0.2}) {
      const Runs runs = RunSeeds(payload_kg, {}, 3, experiment);
      Print(experiment, runs);
      EXPECT_EQ(runs.tripped, 0) << experiment << " " << payload_kg;
      // Smaller moves (20 deg) and gentler ones (sine) than the base command's bar at 0.2 kg.
      EXPECT_LE(Largest(runs.rms1_deg), 1.3 * 1.10) << experiment << " " << payload_kg;
      EXPECT_LE(Largest(runs.rms2_deg), 1.3 * 3.0) << experiment << " " << payload_kg;
    }
  }
}

// No bar of the design study: a smooth move is easier than the base command's square, so its bars
// must hold. Measured at 0.01, 0.1, 0.2 kg: rms 0.43 0.32, 0.40 0.56, 0.46 1.36 deg, final at most
// 0.16 deg, residual at most 4.0 mm.
TEST(LoopVariants, TheWayPointsAreReachedAndTheArmRestsThere) {
  for (const double payload_kg : {0.01, 0.1, 0.2}) {
    const Runs runs = RunSeeds(payload_kg, {}, 3, "waypoints");
    Print("waypoints", runs);
    EXPECT_EQ(runs.tripped, 0) << payload_kg;
    EXPECT_LE(Largest(runs.rms1_deg), 1.3 * 1.10) << payload_kg;
    EXPECT_LE(Largest(runs.rms2_deg), 1.3 * 3.0) << payload_kg;
    EXPECT_LE(Largest(runs.final1_deg), 1.3 * 0.35) << payload_kg;
    EXPECT_LE(Largest(runs.final2_deg), 1.3 * 0.35) << payload_kg;
    EXPECT_LE(Largest(runs.residual_mm), 1.3 * 6.0) << payload_kg;
  }
}

// The design study: 7.5 and 1.5 N m do not degrade the motion. The rms bars at 0.1 kg hold as they
// are, and the limits are really reached. Measured: rms 0.77 and 1.10 deg.
TEST(LoopVariants, QuarterTorqueLimitsKeepTheBars) {
  const Runs runs = RunSeeds(0.1, {"limits.torque_limit_nm=[7.5, 1.5]"});
  Print("7.5 and 1.5 N m", runs);
  EXPECT_EQ(runs.tripped, 0);
  EXPECT_LE(Median(runs.rms1_deg), 0.90);
  EXPECT_LE(Median(runs.rms2_deg), 1.35);
  EXPECT_LE(Largest(runs.peak1_nm), 7.5);
  EXPECT_LE(Largest(runs.peak2_nm), 1.5);
  EXPECT_GT(Largest(runs.peak1_nm), 7.4) << "the limit was never reached: the test is inconclusive";
}

// docs/theory/control-law.md 12.6: one degree of backlash, friction x 3, joint springs -30 %,
// Young's modulus -10 %, 3 % modal damping, unknown to the controller. Stable, and at rest at the
// end. With backlash the arm has a limit cycle under any feedback: it comes to rest because a stop
// ramps the torque to zero.
TEST(LoopVariants, PlantsThatDifferFromTheDesignAreStable) {
  for (const PlantVariant& variant : PlantVariants()) {
    const RigConfig config = ShippedRig();
    for (const double payload_kg : {0.0, 0.01, 0.1, 0.2}) {
      for (const char* seed : {"1", "2", "3"}) {
        std::vector<std::string> overrides = VariantOverrides(config, variant.name);
        overrides.push_back(std::string("sim.seed=") + seed);
        const SimulationResult result = Simulate({.config = config,
                                                  .experiment = ShippedExperiment(),
                                                  .plant = PlantWith(config, overrides),
                                                  .payload_kg = payload_kg,
                                                  .log = {}});
        EXPECT_TRUE(result.completed) << variant.name << " " << payload_kg << " kg, seed " << seed
                                      << ": " << ToString(result.trip);
      }
    }
  }
}

// The prescribed degree of stability removes the final error. Measured: 0.45 against 0.04
// deg (design study: 1.2 against 0.15).
TEST(LoopVariants, WithoutPrescribedStabilityTheFinalErrorIsFourTimesLarger) {
  const std::vector<std::string> corrected = {kThesisLaw, "controller.feedforward_sign=corrected",
                                              "controller.vartheta=0.5"};
  std::vector<std::string> slow = corrected;
  slow.push_back("controller.alpha=0.0");
  const Runs fast = RunSeeds(0.1, corrected), at_zero = RunSeeds(0.1, slow);
  Print("alpha 3", fast);
  Print("alpha 0", at_zero);
  const double error3 = std::max(Median(fast.final1_deg), Median(fast.final2_deg));
  const double error0 = std::max(Median(at_zero.final1_deg), Median(at_zero.final2_deg));
  EXPECT_GE(error0, 4.0 * error3);
}

// The interior optimum of (7.24), which exists with the printed sign and this command only: at
// least 20 % below vartheta 0 and 40 % below 1. Measured: 1.10, 0.75, 2.35 deg.
TEST(LoopVariants, TheBlendOfFeedforwardsBeatsBothEnds) {
  const Runs none = RunSeeds(0.1, {"controller.vartheta=0.0"}),
             blend = RunSeeds(0.1, {"controller.vartheta=0.35"}),
             all = RunSeeds(0.1, {"controller.vartheta=1.0"});
  Print("vartheta 0", none);
  Print("vartheta 0.35", blend);
  Print("vartheta 1", all);
  EXPECT_LE(Median(blend.rms1_deg), 0.8 * Median(none.rms1_deg));
  EXPECT_LE(Median(blend.rms1_deg), 0.6 * Median(all.rms1_deg));
}

}  // namespace
}  // namespace flexarm
