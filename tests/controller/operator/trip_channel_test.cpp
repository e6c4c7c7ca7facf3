#include "controller/operator/trip_channel.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

TEST(TripChannelName, IsWhatTheConfigCallsIt) {
  SensorConfig sensors{};
  for (const int link : {1, 1, 2, 2, 2}) {
    sensors.strain.push_back(
        {.link = link, .position_m = 0.1, .face = 1, .gain_v_per_unit = 1.0, .offset_counts = 0.0});
  }
  EXPECT_EQ(TripChannelName(TripCause::kStrainSaturated, 4, sensors), "strain_2_02");
  EXPECT_EQ(TripChannelName(TripCause::kEncoderJump, 3, sensors), "rotor1");
  EXPECT_EQ(TripChannelName(TripCause::kSoftLimit2, 2, sensors), "joint 2");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 1, sensors), "read failed");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 2, sensors), "write failed");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 3, sensors), "read too slow");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 4, sensors), "write too slow");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 5, sensors), "relay stays closed");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 6, sensors), "relay stays open");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 7, sensors), "charge pump stuck on");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 8, sensors), "no drive voltage");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 9, sensors), "drive voltage stays on");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 10, sensors), "drive voltage not known");
  EXPECT_EQ(TripChannelName(TripCause::kSafetyLines, 99, sensors), "") << "a corrupt number";
  EXPECT_EQ(TripChannelName(TripCause::kStaleFrame, 0, sensors), "");
  EXPECT_EQ(TripChannelName(TripCause::kStrainStuck, 99, sensors), "") << "a corrupt number";
}

}  // namespace
}  // namespace flexarm
