#include "controller/types/frame_packet.h"

#include <gtest/gtest.h>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

FramePacket Encoders(std::int64_t sampled_at_ns) {
  FramePacket packet{};
  packet.frame.sampled_at_ns = sampled_at_ns;
  packet.frame.counter = {1, 2, 3, 4};
  packet.frame.counter_offset_ns = {10, 20, 30, 40};
  packet.frame.counter_valid = 0b1111;
  packet.applied_torque_nm = {1.5, 0.0};
  return packet;
}

FramePacket Gauges(std::int64_t sampled_at_ns) {
  FramePacket packet{};
  packet.frame.sampled_at_ns = sampled_at_ns;
  packet.frame.counter = {99, 99, 99, 99};  // not its own, not valid
  packet.frame.strain[7] = -5;
  packet.frame.strain_offset_ns[7] = 100;
  packet.frame.strain_valid = 1u << 7;
  packet.frame.accelerometer[0] = 12;
  packet.frame.accelerometer_valid = 1;
  packet.applied_torque_nm = {0.0, 0.25};
  return packet;
}

TEST(JoinFrames, TakesFromEachBusItsOwnReadings) {
  FramePacket packet = Encoders(20 * kMs);
  Join(Gauges(20 * kMs), &packet);
  EXPECT_EQ(packet.frame.counter, (std::array<std::uint32_t, 4>{1, 2, 3, 4}));
  EXPECT_EQ(packet.frame.counter_valid, 0b1111u);
  EXPECT_EQ(packet.frame.strain[7], -5);
  EXPECT_EQ(packet.frame.strain_valid, 1u << 7);
  EXPECT_EQ(packet.frame.accelerometer[0], 12);
  EXPECT_EQ(packet.frame.accelerometer_valid, 1u);
  EXPECT_EQ(packet.applied_torque_nm, (std::array<double, 2>{1.5, 0.25}));
}

TEST(JoinFrames, KeepsTheInstantOfEveryReading) {
  FramePacket packet = Encoders(20 * kMs);
  Join(Gauges(23 * kMs), &packet);
  EXPECT_EQ(packet.frame.sampled_at_ns + packet.frame.strain_offset_ns[7], 23 * kMs + 100);
  EXPECT_EQ(packet.frame.sampled_at_ns + packet.frame.counter_offset_ns[2], 20 * kMs + 30);
}

// A first bus that never sent a frame is at instant 0: an offset of hours cannot be represented.
TEST(JoinFrames, ASilentBusDoesNotAffectTheOther) {
  FramePacket packet{};
  Join(Gauges(3'600'000 * kMs), &packet);
  EXPECT_EQ(packet.frame.sampled_at_ns, 3'600'000 * kMs);
  EXPECT_EQ(packet.frame.strain_valid, 1u << 7);

  FramePacket living = Gauges(3'600'000 * kMs);
  Join(Encoders(20 * kMs), &living);
  EXPECT_EQ(living.frame.counter_valid, 0u) << "an hour old";
  EXPECT_EQ(living.frame.strain_valid, 1u << 7);
}

}  // namespace
}  // namespace flexarm
