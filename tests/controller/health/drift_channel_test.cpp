#include "controller/health/drift_channel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "controller/health/parallel_plant.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

std::vector<std::string> Keys(const ArmParameters& arm, const SensorConfig& sensors) {
  std::vector<std::string> keys;
  for (const DriftChannel& channel : DriftChannels(arm, sensors)) keys.push_back(channel.Key());
  return keys;
}

// Ten gauges a link with two figures each, friction and stiffness of two joints, stiffness of two
// links, payload.
TEST(DriftChannel, TheThesisRigHas47) {
  const std::vector<DriftChannel> channels = DriftChannels(ThesisRig(), ThesisSensors());
  ASSERT_EQ(channels.size(), 47u);
  EXPECT_EQ(channels[13].Key(), "link1.gauge7.gain");
  EXPECT_EQ(channels[13].Name(), "gauge 7 of link 1: gain");
  EXPECT_EQ(channels[13].strain, 6u);
  EXPECT_EQ(channels[46].Key(), "link2.gauge10.zero");
  EXPECT_EQ(channels[46].strain, 19u);
}

TEST(DriftChannel, AStiffnessOfAnotherArmOrNoNumberIsNoDrift) {
  const std::vector<DriftChannel> channels = DriftChannels(ThesisRig(), ThesisSensors());
  std::vector<double> drift(channels.size(), 0.0);
  EXPECT_TRUE(IsPossible(channels, drift));
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const bool of_stiffness = channels[i].kind == DriftKind::kJointStiffness ||
                              channels[i].kind == DriftKind::kLinkStiffness;
    for (const double far : {-0.91, 0.91}) {  // a tenth of the stiffness is left, or twice as much
      drift[i] = far;
      EXPECT_EQ(IsPossible(channels, drift), !of_stiffness) << channels[i].Key();
      drift[i] = 0.98 * far;
      EXPECT_TRUE(IsPossible(channels, drift)) << channels[i].Key();
    }
    drift[i] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(IsPossible(channels, drift)) << channels[i].Key();
    drift[i] = 0.0;
  }
}

TEST(DriftChannel, WhatTheSensorsDoNotSeeHasNoFigure) {
  SensorConfig sensors = ThesisSensors();
  ASSERT_THAT(Keys(ThesisRig(), sensors), testing::Contains("joint2.stiffness"));
  sensors.encoder.pop_back();  // rotor 2
  EXPECT_THAT(Keys(ThesisRig(), sensors), testing::Not(testing::Contains("joint2.stiffness")));
  EXPECT_THAT(Keys(ThesisRig(), sensors), testing::Contains("joint1.stiffness"));
  ArmParameters smooth = ThesisRig();
  smooth.joint[0].coulomb_friction_nm = 0.0;
  EXPECT_THAT(Keys(smooth, sensors), testing::Not(testing::Contains("joint1.friction")));
}

}  // namespace
}  // namespace flexarm
