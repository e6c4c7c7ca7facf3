#include "controller/commissioning/angle_knowledge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controller/types/trip_cause.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

SensorConfig FourEncoders() {
  SensorConfig sensors{};
  for (int i = 0; i < kCounters; ++i) {
    sensors.encoder.push_back(
        {.counter = i, .counts_per_turn = 2540, .counter_bits = 32, .sign = 1});
  }
  return sensors;
}

// A step in Idle with good readings, at angle 0.
TickRecord Tick() {
  TickRecord tick{};
  tick.input.safety_state = SafetyState::kIdle;
  tick.input.frame.counter_valid = 0b1111;
  tick.output.counters_used = 0b1111;
  return tick;
}

TEST(AngleKnowledge, BeginsAsTheConfigSays) {
  EXPECT_EQ(AngleKnowledge(AnglesAtStart::kAtZero, FourEncoders()).unknown(), 0);
  EXPECT_EQ(AngleKnowledge(AnglesAtStart::kAbsolute, FourEncoders()).unknown(), 0);
  const AngleKnowledge lost(AnglesAtStart::kLost, FourEncoders());
  EXPECT_EQ(lost.unknown(), 0b11);
  EXPECT_THAT(lost.Text(1), HasSubstr("The angle of joint 2 is unknown: it has not been set"));
}

TEST(AngleKnowledge, ACounterOfAJointThatLosesItsCountCostsItsAngle) {
  for (std::size_t counter = 0; counter < 4; ++counter) {
    AngleKnowledge angles(AnglesAtStart::kAtZero, FourEncoders());
    EXPECT_EQ(angles.Follow(CountEpochs{}), 0);
    CountEpochs epochs{};
    epochs[counter] = 1;
    const std::uint8_t joint = counter % 2 == 0 ? 0b01 : 0b10;
    EXPECT_EQ(angles.Follow(epochs), joint);
    EXPECT_EQ(angles.unknown(), joint);
    EXPECT_EQ(angles.Follow(epochs), 0) << "no change";
    EXPECT_EQ(angles.unknown(), joint);
    angles.Know(counter % 2);
    EXPECT_EQ(angles.unknown(), 0);
    EXPECT_EQ(angles.Text(counter % 2), "");
    EXPECT_EQ(angles.Follow(epochs), 0) << "known until the next loss";
    ++epochs[counter];
    EXPECT_EQ(angles.Follow(epochs), joint);
  }
}

TEST(AngleKnowledge, AJumpCostsTheAngle) {
  AngleKnowledge angles(AnglesAtStart::kAtZero, FourEncoders());
  TickRecord tick = Tick();
  EXPECT_EQ(angles.Follow(tick), 0);
  tick.input.frame.counter_valid = 0b1101;
  tick.output.counters_used = 0b1101;
  EXPECT_EQ(angles.Follow(tick), 0) << "a reading that is missing is no jump";
  tick.input.frame.counter_valid = 0b1111;
  EXPECT_EQ(angles.Follow(tick), 0) << "nor is one that came too late";
  tick.output.faults = CauseBit(TripCause::kEncoderJump);
  EXPECT_EQ(angles.Follow(tick), 0b10);
  EXPECT_THAT(angles.Text(1), HasSubstr("its encoder jumped"));
}

TEST(AngleKnowledge, AnAbsoluteEncoderKeepsItsAngle) {
  AngleKnowledge angles(AnglesAtStart::kAbsolute, FourEncoders());
  EXPECT_EQ(angles.Follow(CountEpochs{1, 1, 1, 1}), 0);
  TickRecord tick = Tick();
  tick.output.counters_used = 0;
  tick.output.faults = CauseBit(TripCause::kEncoderJump);
  EXPECT_EQ(angles.Follow(tick), 0);
  EXPECT_EQ(angles.unknown(), 0);
}

TEST(AngleKnowledge, AnUnknownJointBeginsAtZeroWhereItStands) {
  AngleKnowledge angles(AnglesAtStart::kAtZero, FourEncoders());
  angles.Follow(CountEpochs{1, 0, 0, 0});
  TickRecord tick = Tick();
  tick.output.counts = {500, 600, 700, 800};
  tick.output.angle_rad = {0.0, 1.0, 0.02, 1.0};
  const auto begun = [&] {
    Calibration calibration{};
    angles.BeginAtZero(tick, &calibration);
    return calibration.counter_zero;
  };
  using Zeros = std::array<std::int64_t, kCounters>;
  EXPECT_EQ(begun(), Zeros{}) << "within the play of the joint";
  tick.output.angle_rad[2] = 0.5;
  EXPECT_EQ(begun(), (Zeros{500, 0, 700, 0})) << "hub and rotor, and not of the known joint";
  tick.output.counters_used = 0b1110;
  EXPECT_EQ(begun(), Zeros{}) << "not from an old reading";
  tick.output.counters_used = 0b1111;
  for (const SafetyState state :
       {SafetyState::kRunning, SafetyState::kStopping, SafetyState::kFaultStopping}) {
    tick.input.safety_state = state;
    EXPECT_EQ(begun(), Zeros{}) << ToString(state);
  }
}

TEST(AngleKnowledge, BothJointsMayBecomeUnknownAtOnce) {
  AngleKnowledge angles(AnglesAtStart::kAtZero, FourEncoders());
  EXPECT_EQ(angles.Follow(CountEpochs{1, 0, 0, 1}), 0b11);
  EXPECT_EQ(angles.unknown(), 0b11);
}

TEST(AngleKnowledge, EachUnknownJointBeginsAtZeroWhoseReadingsAreThere) {
  AngleKnowledge angles(AnglesAtStart::kLost, FourEncoders());
  TickRecord tick = Tick();
  tick.output.counts = {500, 600, 700, 800};
  tick.output.angle_rad = {1.0, 1.0, 1.0, 1.0};
  for (const std::uint32_t used : {0b0101U, 0b1010U, 0b1111U}) {
    tick.output.counters_used = used;
    Calibration calibration{};
    angles.BeginAtZero(tick, &calibration);
    for (std::size_t i = 0; i < kCounters; ++i) {
      EXPECT_EQ(calibration.counter_zero[i], (used >> i & 1U) != 0 ? tick.output.counts[i] : 0);
    }
  }
}

// 0.035 rad: what the play of a joint at rest may be.
TEST(AngleKnowledge, WithinThePlayOfAJointNothingBegins) {
  const AngleKnowledge angles(AnglesAtStart::kLost, FourEncoders());
  TickRecord tick = Tick();
  tick.output.counts.fill(500);
  tick.output.angle_rad.fill(0.035);
  Calibration calibration{};
  angles.BeginAtZero(tick, &calibration);
  EXPECT_EQ(calibration.counter_zero, (std::array<std::int64_t, kCounters>{}));
}

}  // namespace
}  // namespace flexarm
