// What the rules of a torture session ask of a fault.

#include "tools/torture/detection.h"

#include <gtest/gtest.h>

#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

constexpr int kLimit1High = 1;  // lines, as in hal/sensor_frame.h
constexpr int kLimit2Low = 2;
constexpr int kEmergencyStop = 4;
constexpr int kHub2 = 1;  // counters, as in hal/sensor_config.h
constexpr int kRotor2 = 3;

Fault Of(FaultPlace place, int index, FaultKind kind) {
  return {.place = place, .index = index, .kind = kind, .from_ns = 0, .to_ns = 1, .seed = 0};
}

const Fault kStuckSwitch = Of(FaultPlace::kLine, kLimit2Low, FaultKind::kStuck);
const Fault kDriftingFrame = Of(FaultPlace::kFrame, 0, FaultKind::kDrifting);

TEST(HideAngle, AStuckSwitchAndEncodersThatDriftTogether) {
  const RigConfig config = ShippedRig();
  EXPECT_TRUE(HideAngle(config, {kStuckSwitch, kDriftingFrame}, 1));
  EXPECT_FALSE(HideAngle(config, {kStuckSwitch, kDriftingFrame}, 0)) << "its switches are well";
  EXPECT_TRUE(HideAngle(config,
                        {kStuckSwitch, Of(FaultPlace::kCounter, kHub2, FaultKind::kDrifting),
                         Of(FaultPlace::kCounter, kRotor2, FaultKind::kDrifting)},
                        1));
}

TEST(HideAngle, NotWhileAnythingMeasuresIt) {
  const RigConfig config = ShippedRig();
  EXPECT_FALSE(HideAngle(config, {kStuckSwitch}, 1));
  EXPECT_FALSE(HideAngle(config, {kDriftingFrame}, 1));
  for (const int counter : {kHub2, kRotor2}) {
    const Fault drifts = Of(FaultPlace::kCounter, counter, FaultKind::kDrifting);
    EXPECT_FALSE(HideAngle(config, {kStuckSwitch, drifts}, 1)) << "the other encoder tells";
  }
  const Fault other_joint = Of(FaultPlace::kLine, kLimit1High, FaultKind::kStuck);
  EXPECT_FALSE(HideAngle(config, {other_joint, kDriftingFrame}, 1));
  const Fault no_limit = Of(FaultPlace::kLine, kEmergencyStop, FaultKind::kStuck);
  EXPECT_FALSE(HideAngle(config, {no_limit, kDriftingFrame}, 1));
  const Fault opens = Of(FaultPlace::kLine, kLimit2Low, FaultKind::kGarbage);
  EXPECT_FALSE(HideAngle(config, {opens, kDriftingFrame}, 1)) << "it opens within milliseconds";
  const Fault named = Of(FaultPlace::kFrame, 0, FaultKind::kGarbage);
  EXPECT_FALSE(HideAngle(config, {kStuckSwitch, named}, 1)) << "named within three ticks";
}

}  // namespace
}  // namespace flexarm
