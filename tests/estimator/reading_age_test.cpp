#include "estimator/reading_age.h"

#include <gtest/gtest.h>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr std::int64_t kInstant = 1'000 * kMs;

SensorFrame FrameAt(std::int64_t sampled_at_ns) {
  SensorFrame frame{};
  frame.sampled_at_ns = sampled_at_ns;
  frame.counter_valid = 0b1111;
  frame.strain_valid = 0xFFFFF;
  frame.accelerometer_valid = 1;
  return frame;
}

TEST(ReadingAge, ReadingsOfTheInstantStayValid) {
  const SensorFrame frame = WithoutStaleReadings(FrameAt(kInstant), kInstant, 10 * kMs);
  EXPECT_EQ(frame.counter_valid, 0b1111u);
  EXPECT_EQ(frame.strain_valid, 0xFFFFFu);
  EXPECT_EQ(frame.accelerometer_valid, 1u);
}

TEST(ReadingAge, AnAgeAtTheLimitIsValidAndANanosecondMoreIsNot) {
  for (const int side : {-1, 1}) {  // before the instant, after it
    const std::int64_t at_limit = kInstant + side * 10 * kMs;
    EXPECT_EQ(WithoutStaleReadings(FrameAt(at_limit), kInstant, 10 * kMs).counter_valid, 0b1111u);
    const SensorFrame beyond = WithoutStaleReadings(FrameAt(at_limit + side), kInstant, 10 * kMs);
    EXPECT_EQ(beyond.counter_valid, 0u);
    EXPECT_EQ(beyond.strain_valid, 0u);
    EXPECT_EQ(beyond.accelerometer_valid, 0u);
  }
}

// Each reading by its own offset: here the frame is recent, two of its readings are stale.
TEST(ReadingAge, EachReadingIsJudgedByItsOwnOffset) {
  SensorFrame frame = FrameAt(kInstant);
  frame.counter_offset_ns[2] = -20'000'000;
  frame.strain_offset_ns[7] = -20'000'000;
  frame = WithoutStaleReadings(frame, kInstant, 10 * kMs);
  EXPECT_EQ(frame.counter_valid, 0b1011u);
  EXPECT_EQ(frame.strain_valid, 0xFFFFFu & ~(1u << 7));
}

TEST(ReadingAge, AnInvalidReadingStaysInvalid) {
  SensorFrame frame = FrameAt(kInstant);
  frame.counter_valid = 0b0101;
  EXPECT_EQ(WithoutStaleReadings(frame, kInstant, 10 * kMs).counter_valid, 0b0101u);
}

TEST(ReadingAge, ReportsWhetherTheGoodStrainsAreOfTheInstant) {
  SensorFrame frame{};
  frame.sampled_at_ns = 100;
  frame.strain_valid = 0b111;
  EXPECT_TRUE(StrainsAreOf(frame, 100));
  EXPECT_FALSE(StrainsAreOf(frame, 101));
  frame.strain_offset_ns[2] = 5;
  EXPECT_FALSE(StrainsAreOf(frame, 100));
  frame.strain_valid = 0b011;  // a reading that is not good is ignored
  EXPECT_TRUE(StrainsAreOf(frame, 100));
}

}  // namespace
}  // namespace flexarm
