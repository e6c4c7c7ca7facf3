// From which frame on the rules of a torture session ask that a wrong reading is named.

#include "tools/torture/faulty_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

constexpr std::size_t kSecondHub = 1;  // counter, as in hal/sensor_config.h
constexpr int kFaultyFrame = 10;       // the first frame with the fault

/// The shipped rig, with a fault of the hub encoder of joint 2 from frame kFaultyFrame on.
class FaultyFramesTest : public testing::Test {
 protected:
  RigConfig config_ = ShippedRig();

  FaultyFramesTest() {
    for (EncoderConfig& encoder : config_.sensors.encoder) encoder.counter_bits = 24;
  }

  void RemoveRotors() {
    std::erase_if(config_.sensors.encoder,
                  [](const EncoderConfig& encoder) { return encoder.counter > 1; });
  }

  SensorFrame At(double hub2_rad) const {
    const auto encoder = std::find_if(
        config_.sensors.encoder.begin(), config_.sensors.encoder.end(),
        [](const EncoderConfig& e) { return e.counter == static_cast<int>(kSecondHub); });
    SensorFrame frame{};
    frame.counter_valid = 0b1111;
    frame.strain_valid = 0xFFFFF;
    const auto counts = std::llround(hub2_rad * encoder->counts_per_turn / kTwoPi);
    const auto modulus = std::llround(std::ldexp(1.0, encoder->counter_bits));
    frame.counter[kSecondHub] = static_cast<std::uint32_t>((counts + modulus) % modulus);
    return frame;
  }

  /// Turns the hub from an angle by a step each frame. @returns the frame that shows the fault; -1
  int SeenAt(FaultKind kind, double from_rad, double step_rad, int lost = -1) const {
    const std::int64_t period_ns = config_.loop.period_ns();
    const std::vector<Fault> faults = {{.place = FaultPlace::kCounter,
                                        .index = static_cast<int>(kSecondHub),
                                        .kind = kind,
                                        .from_ns = kFaultyFrame * period_ns,
                                        .to_ns = INT64_MAX,
                                        .seed = 1}};
    FaultyFrames frames(config_, faults);
    for (int k = 0; k < 2 * kFaultyFrame; ++k) {
      SensorFrame frame = At(from_rad + step_rad * k);
      if (k == lost) frame.counter_valid = 0;
      frames.Next(frame, k * period_ns);
    }
    return frames.seen_ns() == INT64_MAX ? -1 : static_cast<int>(frames.seen_ns() / period_ns);
  }
};

// hub_rotor_limit_rad is 0.1: off by more than 0.11 in three frames, of which the first counts.
TEST_F(FaultyFramesTest, AHubWithARotorEncoderIsSeenOnceItIsOff) {
  EXPECT_EQ(SeenAt(FaultKind::kStuck, 0.0, 0.12), kFaultyFrame);
  EXPECT_EQ(SeenAt(FaultKind::kStuck, 0.0, 0.04), kFaultyFrame + 2);
  EXPECT_EQ(SeenAt(FaultKind::kStuck, 0.0, 0.01), -1);
  EXPECT_EQ(SeenAt(FaultKind::kWrongScale, 1.0, 0.0), kFaultyFrame);
}

// A third of that a frame, and half again for the model: 0.05 before and in the first frame.
TEST_F(FaultyFramesTest, AHubAloneIsSeenIfItStandsStillInMidTurn) {
  RemoveRotors();
  EXPECT_EQ(SeenAt(FaultKind::kStuck, 0.0, 0.055), kFaultyFrame);
  EXPECT_EQ(SeenAt(FaultKind::kStuck, 0.0, -0.055), kFaultyFrame);
  EXPECT_EQ(SeenAt(FaultKind::kStuck, 0.0, 0.045), -1);
  EXPECT_EQ(SeenAt(FaultKind::kStuck, 0.0, 0.055, kFaultyFrame - 1), -1) << "its turn is not known";
}

// innovation_limit_rad is 0.35, and half again: 0.535 at once. Any scale is off by half at least.
TEST_F(FaultyFramesTest, AHubAloneIsSeenIfItJumps) {
  RemoveRotors();
  EXPECT_EQ(SeenAt(FaultKind::kWrongScale, 1.1, 0.0), kFaultyFrame);
  EXPECT_EQ(SeenAt(FaultKind::kWrongScale, -1.1, 0.0), kFaultyFrame);
  EXPECT_EQ(SeenAt(FaultKind::kWrongScale, 0.2, 0.0), -1);
  EXPECT_EQ(SeenAt(FaultKind::kWrongScale, 0.1, 0.01), -1) << "it goes off slowly";
}

TEST_F(FaultyFramesTest, AMissingReadingIsSeenOfEveryHub) {
  EXPECT_EQ(SeenAt(FaultKind::kOff, 0.2, 0.0), kFaultyFrame);
  RemoveRotors();
  EXPECT_EQ(SeenAt(FaultKind::kOff, 0.2, 0.0), kFaultyFrame);
}

// Two gauges for two modes: the fit follows each wherever it goes.
TEST_F(FaultyFramesTest, AGaugeThatNoOtherChecksIsNotSeen) {
  const auto seen = [this](std::size_t gauge) {
    const Fault garbage = {.place = FaultPlace::kGauge,
                           .index = static_cast<int>(gauge),
                           .kind = FaultKind::kGarbage,
                           .from_ns = 0,
                           .to_ns = INT64_MAX,
                           .seed = 1};
    const std::vector<Fault> faults = {garbage};
    FaultyFrames frames(config_, faults);
    for (int k = 0; k < 100; ++k) frames.Next(At(0.0), k * config_.loop.period_ns());
    return frames.seen_ns() != INT64_MAX;
  };
  EXPECT_TRUE(seen(10));
  const double first_m = config_.sensors.strain[10].position_m;
  const double second_m = config_.sensors.strain[15].position_m;
  std::erase_if(config_.sensors.strain, [first_m, second_m](const StrainChannelConfig& row) {
    return row.link == 2 && row.position_m != first_m && row.position_m != second_m;
  });
  EXPECT_TRUE(seen(9)) << "link 1 has its ten";
  EXPECT_FALSE(seen(10));
}

}  // namespace
}  // namespace flexarm
