// When the control step takes the arm to be at rest.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "model/units.h"
#include "tests/controller/step/fault_detection_fixture.h"

namespace flexarm {
namespace {

// Every second sample lacks the strain of a link: it counts for rest neither way.
TEST_F(FaultDetectionTest, ASampleWithoutStrainIsNoEvidenceOfRest) {
  const int needed = static_cast<int>(std::ceil(config_.safety.rest_time_s / kPeriod_s));
  Facts lost;
  lost.modes.valid[0] = false;
  lost.modes.root_strain[0] = std::numeric_limits<double>::quiet_NaN();
  int samples = 0;
  while (!monitor_.Judge(samples % 2 == 0 ? Facts().Now() : lost.Now()).at_rest) {
    ASSERT_LT(++samples, 10 * needed);
  }
  EXPECT_GE(samples, 2 * (needed - 1));
}

// Slower than the limits of rest, with every second sample lost: the rates are per time, not per
// complete sample, of which there are half as many. At 0.7 of the limit the difference would show.
TEST_F(FaultDetectionTest, ALostSampleDoesNotMakeTheArmFaster) {
  Facts moving, lost = WithoutCounter(0);
  bool at_rest = false;
  for (int k = 0; k < 200; ++k) {
    const double t = k * kPeriod_s;
    moving.modes.root_strain[0] = 0.7 * config_.safety.rest_strain_rate_per_s * t;
    moving.counters.angle_rad[1] = moving.counters.angle_rad[3] =
        0.7 * config_.safety.rest_hub_rate_rad_s * t;
    at_rest = monitor_.Judge(k % 2 == 0 ? moving.Now() : lost.Now()).at_rest;
  }
  EXPECT_TRUE(at_rest);
}

TEST_F(FaultDetectionTest, AnArmThatIsNotMeasuredIsNotAtRest) {
  for (int k = 0; k < 40; ++k) monitor_.Judge(Facts().Now());
  ASSERT_TRUE(monitor_.Judge(Facts().Now()).at_rest);
  EXPECT_TRUE(monitor_.Judge(WithoutCounter(0).Now()).at_rest) << "one sample is bridged";
  EXPECT_FALSE(monitor_.Judge(Unfitted(0, 0).Now()).at_rest);
  EXPECT_FALSE(monitor_.Judge(Unfitted(0, 0).Now()).at_rest);
  int samples = 0;
  while (!monitor_.Judge(Facts().Now()).at_rest && samples < 100) ++samples;
  EXPECT_GE(samples, 24) << "the rest begins again";
}

// Symptom: the log of a second run, armed away from zero, did not replay: a loop that had run
// before detected rest five samples earlier than the one that started with the log.
TEST_F(FaultDetectionTest, ResetClearsTheHubAnglesBefore) {
  Facts elsewhere;
  elsewhere.counters.angle_rad = {0.3, -0.2, 0.3, -0.2};
  elsewhere.modes.root_strain = {2e-4, 1e-4};
  FaultDetection fresh(config_.safety, config_.estimator, kPeriod_s, config_.sensors, kGaugesNeeded,
                       {761.59, 497.96});
  for (int k = 0; k < 38; ++k) monitor_.Judge(elsewhere.Now());  // 38: not a full ring
  monitor_.Reset();
  for (int k = 1; k <= 60; ++k) {
    // Moves from sample 30 to 33, so that the order in the ring buffer has an effect.
    if (k >= 30 && k <= 33) elsewhere.counters.angle_rad[0] += 0.002;
    const bool at_rest = monitor_.Judge(elsewhere.Now()).at_rest;
    EXPECT_EQ(at_rest, fresh.Judge(elsewhere.Now()).at_rest) << k;
    if (k < 30) {
      EXPECT_EQ(at_rest, k >= 25) << "half a second, at any angle: " << k;
    }
  }
}

TEST_F(FaultDetectionTest, ResetForgetsWhereTheArmWas) {
  for (int k = 0; k < 40; ++k) monitor_.Judge(Facts().Now());
  monitor_.Reset();
  Facts elsewhere;
  elsewhere.counters.angle_rad = {0.3, -0.2, 0.3, -0.2};
  elsewhere.modes.root_strain = {2e-4, 1e-4};
  for (int k = 1; k < 25; ++k) EXPECT_FALSE(monitor_.Judge(elsewhere.Now()).at_rest) << k;
  EXPECT_TRUE(monitor_.Judge(elsewhere.Now()).at_rest);
}

// safety.rest_time_s may be shorter than the window over which hub rates are measured.
TEST_F(FaultDetectionTest, AMovingHubIsNotAtRestWithAShortRestTime) {
  SafetyConfig safety = config_.safety;
  safety.rest_time_s = 0.05;
  FaultDetection hasty(safety, config_.estimator, kPeriod_s, config_.sensors, kGaugesNeeded,
                       {761.59, 497.96});
  Facts moving;
  for (int k = 0; k < 20; ++k) {
    moving.counters.angle_rad[0] = moving.counters.angle_rad[2] = 0.06 * kPeriod_s * k;
    EXPECT_FALSE(hasty.Judge(moving.Now()).at_rest) << k;
  }
}

// Not before the window of the hub rates is full: 0.1 s are five samples, and the one before them.
TEST_F(FaultDetectionTest, AShortRestTimeLastsAsLongAsTheWindowOfTheRates) {
  SafetyConfig safety = config_.safety;
  safety.rest_time_s = 0.05;
  FaultDetection hasty(safety, config_.estimator, kPeriod_s, config_.sensors, kGaugesNeeded,
                       {761.59, 497.96});
  for (int k = 1; k < 6; ++k) EXPECT_FALSE(hasty.Judge(Facts().Now()).at_rest) << k;
  EXPECT_TRUE(hasty.Judge(Facts().Now()).at_rest);
}

// The bounds themselves are not at rest. Binary fractions, so that the rates are exact: at 64 Hz
// the window of the hubs has 6 samples, that of the strain one.
TEST_F(FaultDetectionTest, RatesAtTheirBoundsAreNotAtRest) {
  constexpr double kPeriod64_s = 1.0 / 64.0;
  SafetyConfig safety = config_.safety;
  safety.rest_hub_rate_rad_s = 0x1p-4;
  safety.rest_strain_rate_per_s = 0x1p-8;
  FaultDetection detection(safety, config_.estimator, kPeriod64_s, config_.sensors, kGaugesNeeded,
                           {761.59, 497.96});
  const auto rests = [&](double hub1, double hub2, double strain1, double strain2) {
    detection.Reset();
    bool at_rest = false;
    for (int k = 0; k < 60; ++k) {
      Facts facts;
      const double t = k * kPeriod64_s;
      facts.counters.angle_rad = {hub1 * t, hub2 * t, hub1 * t, hub2 * t};
      facts.modes.root_strain = {strain1 * t, strain2 * t};
      at_rest = detection.Judge(facts.Now()).at_rest;
    }
    return at_rest;
  };
  constexpr double kBelow = 1.0 - 0x1p-10;
  EXPECT_TRUE(rests(0x1p-4 * kBelow, -0x1p-4 * kBelow, 0x1p-8 * kBelow, -0x1p-8 * kBelow));
  EXPECT_FALSE(rests(0x1p-4, 0.0, 0.0, 0.0));
  EXPECT_FALSE(rests(0.0, -0x1p-4, 0.0, 0.0));
  EXPECT_FALSE(rests(0.0, 0.0, 0x1p-8, 0.0));
  EXPECT_FALSE(rests(0.0, 0.0, 0.0, -0x1p-8));
}

// At rest: half a second, 25 samples, of slow hubs and slow strain.
TEST_F(FaultDetectionTest, RestIsDetectedAfterHalfASecond) {
  for (int k = 1; k < 25; ++k) EXPECT_FALSE(monitor_.Judge(Facts().Now()).at_rest) << k;
  EXPECT_TRUE(monitor_.Judge(Facts().Now()).at_rest);
}

TEST_F(FaultDetectionTest, AMovingHubIsNotAtRestButAFlickeringCountIs) {
  Facts moving;
  for (int k = 0; k < 60; ++k) {  // 0.06 rad/s, the bound being 0.05
    moving.counters.angle_rad[0] = moving.counters.angle_rad[2] = 0.06 * kPeriod_s * k;
    EXPECT_FALSE(monitor_.Judge(moving.Now()).at_rest);
  }
  monitor_.Reset();
  Facts flicker;  // one count of 2540 back and forth: 0.12 rad/s from sample to sample
  bool at_rest = false;
  for (int k = 0; k < 60; ++k) {
    flicker.counters.angle_rad[0] = k % 2 == 0 ? 0.0 : 2.0 * std::numbers::pi / 2540.0;
    at_rest = monitor_.Judge(flicker.Now()).at_rest;
  }
  EXPECT_TRUE(at_rest);
}

// At 500 Hz one count of 2540 is 1.2 rad/s from sample to sample, and 1 microstrain of noise 7e-4
// 1/s: over 0.1 s and 20 ms they are what they are at 50 Hz.
TEST_F(FaultDetectionTest, AFlickeringCountIsAtRestAtAHighRateToo) {
  constexpr double kFast_s = 0.002;
  FaultDetection fast(config_.safety, config_.estimator, kFast_s, config_.sensors, kGaugesNeeded,
                      {761.59, 497.96});
  Facts flicker;
  bool at_rest = false;
  for (int k = 0; k < 500; ++k) {
    flicker.counters.angle_rad[0] = k % 2 == 0 ? 0.0 : 2.0 * std::numbers::pi / 2540.0;
    flicker.modes.root_strain[1] = k % 3 == 0 ? 2e-5 : 0.0;
    at_rest = fast.Judge(flicker.Now()).at_rest;
  }
  EXPECT_TRUE(at_rest);
  Facts moving;
  for (int k = 0; k < 500; ++k) {
    moving.counters.angle_rad[0] = moving.counters.angle_rad[2] = 0.06 * kFast_s * k;
    const bool rests = fast.Judge(moving.Now()).at_rest;
    EXPECT_FALSE(rests && k > 50) << k;  // until then the window has the rest before it
  }
}

// 1.2e-4 of strain a sample is 6e-3 1/s, the bound being 5e-3.
TEST_F(FaultDetectionTest, ABendingLinkIsNotAtRest) {
  Facts bending;
  for (int k = 0; k < 60; ++k) {
    bending.modes.root_strain[1] = (k % 2 == 0 ? 1.0 : -1.0) * 0.6e-4;
    EXPECT_FALSE(monitor_.Judge(bending.Now()).at_rest);
  }
}

TEST_F(FaultDetectionTest, AMovementRestartsTheHalfSecond) {
  for (int k = 0; k < 40; ++k) monitor_.Judge(Facts().Now());
  ASSERT_TRUE(monitor_.Judge(Facts().Now()).at_rest);
  Facts moved;
  moved.counters.angle_rad[0] = moved.counters.angle_rad[2] = 0.05;
  EXPECT_FALSE(monitor_.Judge(moved.Now()).at_rest);
  int samples = 0;
  while (!monitor_.Judge(moved.Now()).at_rest && samples < 100) ++samples;
  EXPECT_EQ(samples, 4 + 24) << "the window of five samples delays it, and the 25th is at rest";
}

}  // namespace
}  // namespace flexarm
