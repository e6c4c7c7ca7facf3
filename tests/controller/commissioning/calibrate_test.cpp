#include "controller/commissioning/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "controller/types/rejected_error.h"
#include "model/arm/arm_model.h"
#include "model/math/dense_decompositions.h"
#include "tests/controller/commissioning/rest_ticks.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::Not;

class CalibrateTest : public testing::Test {
 protected:
  std::vector<double> Flat(double counts) const {
    return std::vector<double>(config_.sensors.strain.size(), counts);
  }

  // What the channels of `link` read under `load`, in counts above zero, by the config's gains.
  std::vector<double> Loaded(const StaticLoad& load) const {
    std::vector<double> counts = Flat(0.0);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const StrainChannelConfig& row = config_.sensors.strain[i];
      if (row.link != load.link) continue;
      counts[i] = StaticStrain(config_.arm.link[static_cast<std::size_t>(load.link - 1)], load,
                               row.position_m) *
                  row.face * row.gain_v_per_unit / config_.sensors.strain_input.volts_per_count();
    }
    return counts;
  }

  const RigConfig config_ = ShippedRig();
};

// The mean of 50 samples with noise of one count is accurate to 0.14 counts; four times that.
constexpr double kMeanTolerance_counts = 0.6;

TEST_F(CalibrateTest, TareTakesTheMeanOfEveryChannelAsItsZero) {
  std::vector<double> counts = Flat(0.0);
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = 10.0 * static_cast<double>(i) - 90.0;
  const Calibration found = Tare(config_.sensors, StillArm(config_.sensors, counts), {});
  for (std::size_t i = 0; i < counts.size(); ++i) {
    EXPECT_NEAR(found.strain_zero_counts[i], counts[i], kMeanTolerance_counts) << i;
    EXPECT_EQ(found.strain_gain_error[i], 0.0f);
  }
}

TEST_F(CalibrateTest, TareNamesExactlyTheImplausibleChannels) {
  RestReadings readings = StillArm(config_.sensors, Flat(0.0));
  readings.strain_missing[2] = 11;  // a fifth of the 50 may be missing
  readings.strain_missing[3] = 10;
  readings.strain_sigma[7] = 40.0;    // a loose contact
  readings.strain_mean[15] = 1900.0;  // bytes in the wrong order, or a broken bridge
  const std::string message =
      MessageOf<RejectedError>([&] { Tare(config_.sensors, readings, {}); });
  EXPECT_THAT(message, HasSubstr("strain_1_03: 11 of 50 readings are missing, at most 10 may be"));
  EXPECT_THAT(message, HasSubstr("strain_1_08: varies by 40.0"));
  EXPECT_THAT(message, HasSubstr("strain_2_06: is 1900"));
  EXPECT_THAT(message, Not(HasSubstr("strain_1_01")));
  EXPECT_THAT(message, Not(HasSubstr("strain_1_04")));
}

TEST_F(CalibrateTest, TareCountsFromTheOffsetOfTheConfigAndTakesAQuarterOfTheRange) {
  SensorConfig sensors = config_.sensors;
  sensors.strain[6].offset_counts = 100.0;
  RestReadings readings = StillArm(sensors, Flat(0.0));
  readings.strain_mean[6] = 130.0;
  readings.strain_mean[9] = 0.25 * sensors.strain_input.highest_count();
  const Calibration found = Tare(sensors, readings, {});
  EXPECT_EQ(found.strain_zero_counts[6], 30.0F);
  EXPECT_EQ(found.strain_zero_counts[9], 511.75F) << "as much as is allowed";
}

// One finding a channel: what was hardly read is not judged for noise as well.
TEST_F(CalibrateTest, AChannelIsNamedOnce) {
  RestReadings readings = StillArm(config_.sensors, Flat(0.0));
  readings.strain_missing[2] = 11;
  readings.strain_sigma[2] = 40.0;
  readings.strain_mean[2] = 1900.0;
  readings.strain_sigma[7] = 40.0;
  readings.strain_mean[7] = 1900.0;
  const std::string message =
      MessageOf<RejectedError>([&] { Tare(config_.sensors, readings, {}); });
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 2) << message;
}

// Six times the noise of a count and of its rounding, 0.29 counts.
TEST_F(CalibrateTest, TareTakesSixSigmaOfNoise) {
  ASSERT_EQ(config_.sensors.strain_input.noise_counts, 1.0);
  const auto tared = [this](double sigma) {
    RestReadings readings = StillArm(config_.sensors, Flat(0.0));
    readings.strain_sigma[4] = sigma;
    return MessageOf<RejectedError>([&] { Tare(config_.sensors, readings, {}); }).empty();
  };
  EXPECT_TRUE(tared(6.0 * std::hypot(1.0, 0.29)));
  EXPECT_FALSE(tared(6.0 * std::hypot(1.0, 0.29) + 1e-6));
}

TEST_F(CalibrateTest, ZeroPutsHubAndRotorOfAJointAtTheSameAngle) {
  const RestReadings readings = StillArm(config_.sensors, Flat(0.0), {100, 200, 300, 400});
  const Calibration found = Zero(config_.sensors, readings, {0.0, M_PI / 2.0}, {});
  // A quarter turn of 2540 and of 24480 counts.
  EXPECT_EQ(found.counter_zero, (std::array<std::int64_t, 4>{100, 200 - 635, 300, 400 - 6120}));
}

TEST_F(CalibrateTest, ZeroRefusesAnEncoderThatMovesOrIsNotRead) {
  RestReadings readings = StillArm(config_.sensors, Flat(0.0));
  readings.travel_counts[1] = 4;
  readings.counter_missing[2] = 11;
  readings.counter_missing[3] = 50;
  const std::string message =
      MessageOf<RejectedError>([&] { Zero(config_.sensors, readings, {}, {}); });
  EXPECT_THAT(message, HasSubstr("hub2: moved by 4 counts"));
  EXPECT_THAT(message, HasSubstr("rotor1: 11 of 50 readings are missing, at most 10 may be"));
  EXPECT_THAT(message, HasSubstr("rotor2: was not read"));
  EXPECT_THAT(message, Not(HasSubstr("hub1")));
}

// A tenth of a degree, and a count where that is less than one.
TEST_F(CalibrateTest, ZeroTakesATenthOfADegreeOfMotion) {
  SensorConfig sensors = config_.sensors;
  ASSERT_EQ(sensors.encoder[0].counts_per_turn, 2540);
  sensors.encoder[2].counts_per_turn = 36010;  // 10.003 counts
  const auto zeroed = [&](std::size_t counter, std::int64_t travel) {
    RestReadings readings = StillArm(sensors, Flat(0.0));
    readings.travel_counts[counter] = travel;
    return MessageOf<RejectedError>([&] { Zero(sensors, readings, {}, {}); }).empty();
  };
  EXPECT_TRUE(zeroed(0, 1));
  EXPECT_FALSE(zeroed(0, 2));
  EXPECT_TRUE(zeroed(2, 10));
  EXPECT_FALSE(zeroed(2, 11));
}

TEST_F(CalibrateTest, EveryChannelOfTheConfigIsCheckedForItsRange) {
  const auto beyond = [this](auto change) {
    Calibration calibration{};
    change(&calibration);
    return OutOfRange(config_.sensors, calibration);
  };
  EXPECT_EQ(beyond([](Calibration*) {}), "");
  EXPECT_EQ(beyond([](Calibration* c) { c->strain_gain_error[19] = 0.31F; }),
            "strain_2_10: gain_error = 0.31, expected -0.3 to 0.3");
  EXPECT_EQ(beyond([](Calibration* c) { c->strain_zero_counts[19] = -512.0F; }),
            "strain_2_10: zero_counts = -512, expected -511.75 to 511.75");
  EXPECT_EQ(beyond([](Calibration* c) { c->strain_zero_counts[20] = 1e9F; }), "") << "none";
  // The range of the counter, and two turns.
  const EncoderConfig& rotor = config_.sensors.encoder[3];
  const std::int64_t most =
      (std::int64_t{1} << rotor.counter_bits) + 2 * std::llround(rotor.counts_per_turn);
  EXPECT_EQ(beyond([&](Calibration* c) { c->counter_zero[3] = most; }), "");
  EXPECT_EQ(beyond([&](Calibration* c) { c->counter_zero[3] = -most; }), "");
  EXPECT_THAT(beyond([&](Calibration* c) { c->counter_zero[3] = most + 1; }), HasSubstr("rotor2"));
}

// The modes of the arm model solve the same beam independently: K phi = Q with a unit force at the
// tip, where every shape is 1. A concentrated force needs infinitely many modes; with six the
// strain over the inner half of the link agrees to 3 %.
TEST_F(CalibrateTest, StaticStrainAgreesWithTheModesOfTheArm) {
  const ArmModel arm(config_.arm, {.link1 = 6, .link2 = 6});
  for (const int link : {1, 2}) {
    const Eigen::Index first = kRigidCoordinates + (link == 1 ? 0 : 6);
    Eigen::VectorXd q = Eigen::VectorXd::Zero(arm.dof());
    q.segment(first, 6) =
        arm.stiffness().block(first, first, 6, 6).lu().solve(Eigen::VectorXd::Ones(6) * 2.0);
    const double length_m = arm.link_modes(link).length_m;
    const StaticLoad load{.link = link, .force_n = 2.0, .at_m = length_m};
    for (const double share : {0.05, 0.2, 0.35, 0.5}) {
      const double exact = StaticStrain(config_.arm.link[static_cast<std::size_t>(link - 1)], load,
                                        share * length_m);
      EXPECT_NEAR(arm.Strain(link, share * length_m, q), exact, 0.03 * exact) << link << share;
    }
  }
}

TEST_F(CalibrateTest, BeyondTheForceThereIsNoStrain) {
  const StaticLoad load{.link = 1, .force_n = 5.0, .at_m = 0.4};
  EXPECT_EQ(StaticStrain(config_.arm.link[0], load, 0.4), 0.0);
  EXPECT_EQ(StaticStrain(config_.arm.link[0], load, 0.6), 0.0);
}

// By hand, of the section at x: (h/2) F (L - x) / EI.
TEST_F(CalibrateTest, EachSectionOfALinkHasItsOwnStrain) {
  LinkParameters link{};
  for (const auto& [length_m, stiffness_nm2, half_m] :
       {std::array{0.3, 40.0, 0.004}, std::array{0.5, 10.0, 0.002}}) {
    BeamSection section{};
    section.length_m = length_m;
    section.has_cross_section = false;
    section.given_bending_stiffness_nm2 = stiffness_nm2;
    section.half_thickness_m = half_m;
    link.section.push_back(section);
  }
  const StaticLoad load{.link = 1, .force_n = 3.0, .at_m = 0.7};
  EXPECT_NEAR(StaticStrain(link, load, 0.1), 0.004 * 3.0 * 0.6 / 40.0, 1e-15);
  EXPECT_NEAR(StaticStrain(link, load, 0.3), 0.004 * 3.0 * 0.4 / 40.0, 1e-15) << "the joint";
  EXPECT_NEAR(StaticStrain(link, load, 0.4), 0.002 * 3.0 * 0.3 / 10.0, 1e-15);
  const StaticLoad beyond{.link = 1, .force_n = 3.0, .at_m = 1.0};
  EXPECT_NEAR(StaticStrain(link, beyond, 0.9), 0.002 * 3.0 * 0.1 / 10.0, 1e-15) << "the last one";
}

TEST_F(CalibrateTest, GainsCountFromOffsetAndZero) {
  RigConfig config = config_;
  config.sensors.strain[3].offset_counts = 50.0;
  const StaticLoad load{.link = 1, .force_n = 8.0, .at_m = 0.8};
  std::vector<double> counts = Loaded(load);
  RestReadings readings = StillArm(config.sensors, counts);
  readings.strain_mean[3] = 1.1 * counts[3] + 50.0 + 30.0;
  Calibration tared{};
  tared.strain_zero_counts[3] = 30.0F;
  GainCalibration gains(config.arm, config.sensors);
  EXPECT_NEAR(gains.Add(load, readings, tared).strain_gain_error[3], 0.1, 1e-6);
}

// Weighted by their squares: (5^2 1.04 + 10^2 1.01) / (5^2 + 10^2) = 1.016.
TEST_F(CalibrateTest, LoadsThatDisagreeAreWeighted) {
  GainCalibration gains(config_.arm, config_.sensors);
  Calibration found{};
  for (const auto& [force_n, gain] : {std::pair{5.0, 1.04}, std::pair{10.0, 1.01}}) {
    const StaticLoad load{.link = 1, .force_n = force_n, .at_m = 0.8};
    const std::vector<double> counts = Loaded(load);
    RestReadings readings = StillArm(config_.sensors, counts);
    readings.strain_mean[0] = gain * counts[0];
    found = gains.Add(load, readings, found);
  }
  EXPECT_NEAR(found.strain_gain_error[0], 0.016, 1e-8);  // rounded to single precision
}

TEST_F(CalibrateTest, SeveralLoadsGiveTheGainsByLeastSquares) {
  GainCalibration gains(config_.arm, config_.sensors);
  Calibration found{};
  for (const double force_n : {5.0, -3.0, 8.0}) {
    const StaticLoad load{.link = 1, .force_n = force_n, .at_m = 0.8};
    std::vector<double> counts = Loaded(load);
    counts[0] *= 1.04;
    counts[4] *= 0.93;
    found = gains.Add(load, StillArm(config_.sensors, counts), found);
  }
  // Noise of 0.14 counts a mean against some 200 counts and more: below 0.2 %.
  EXPECT_NEAR(found.strain_gain_error[0], 0.04, 2e-3);
  EXPECT_NEAR(found.strain_gain_error[4], -0.07, 2e-3);
  EXPECT_NEAR(found.strain_gain_error[2], 0.0, 2e-3);
  EXPECT_EQ(found.strain_gain_error[12], 0.0f) << "link 2 was not loaded";
}

TEST_F(CalibrateTest, AnImplausibleGainIsRefusedWithItsChannel) {
  const StaticLoad load{.link = 2, .force_n = 1.0, .at_m = 0.9};
  std::vector<double> counts = Loaded(load);
  counts[11] *= -1.0;
  GainCalibration gains(config_.arm, config_.sensors);
  const std::string message =
      MessageOf<RejectedError>([&] { gains.Add(load, StillArm(config_.sensors, counts), {}); });
  EXPECT_THAT(message, HasSubstr("strain_2_02: reads -"));
  EXPECT_THAT(message, Not(HasSubstr("strain_2_01")));
}

// From 20 counts on, at the channel that the load strains most.
TEST_F(CalibrateTest, TheSmallestLoadStrainsAChannelByTwentyCounts) {
  StaticLoad load{.link = 1, .force_n = 1.0, .at_m = 0.8};
  const std::vector<double> at_1_n = Loaded(load);
  const double most =
      std::fabs(*std::max_element(at_1_n.begin(), at_1_n.end(),
                                  [](double a, double b) { return std::fabs(a) < std::fabs(b); }));
  const auto learns = [&](double counts) {
    load.force_n = counts / most;
    GainCalibration gains(config_.arm, config_.sensors);
    const RestReadings readings = StillArm(config_.sensors, Loaded(load));
    return MessageOf<RejectedError>([&] { gains.Add(load, readings, {}); }).empty();
  };
  EXPECT_TRUE(learns(20.01));
  EXPECT_FALSE(learns(19.99));
}

TEST_F(CalibrateTest, ALoadWithoutMeasurableStrainIsRefused) {
  GainCalibration gains(config_.arm, config_.sensors);
  const StaticLoad load{.link = 1, .force_n = 0.01, .at_m = 0.8};
  EXPECT_THAT(MessageOf<RejectedError>(
                  [&] { gains.Add(load, StillArm(config_.sensors, Loaded(load)), {}); }),
              HasSubstr("use a larger load"));
}

}  // namespace
}  // namespace flexarm
