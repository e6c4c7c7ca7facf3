#include "controller/commissioning/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

TEST_F(CalibrateTest, ALoadWithoutMeasurableStrainIsRefused) {
  GainCalibration gains(config_.arm, config_.sensors);
  const StaticLoad load{.link = 1, .force_n = 0.01, .at_m = 0.8};
  EXPECT_THAT(MessageOf<RejectedError>(
                  [&] { gains.Add(load, StillArm(config_.sensors, Loaded(load)), {}); }),
              HasSubstr("use a larger load"));
}

}  // namespace
}  // namespace flexarm
