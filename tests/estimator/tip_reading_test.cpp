#include "estimator/tip_reading.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

constexpr TipAccelerometerConfig kConfig{
    .range_m_s2 = 50.0, .converter_bits = 12, .noise_counts = 1.0, .filter_hz = 200.0};

SensorFrame Frame(std::int32_t counts) {
  SensorFrame frame{};
  frame.accelerometer[0] = counts;
  frame.accelerometer_valid = 1;
  return frame;
}

TEST(TipReading, IsInMetresPerSecondSquaredWithItsSign) {
  EXPECT_DOUBLE_EQ(TipReading(Frame(1024), kConfig).value(), 25.0);
  EXPECT_DOUBLE_EQ(TipReading(Frame(-512), kConfig).value(), -12.5);
}

TEST(TipReading, IsEmptyIfItWasNotRead) {
  SensorFrame frame = Frame(1024);
  frame.accelerometer_valid = 0;
  EXPECT_FALSE(TipReading(frame, kConfig).has_value());
}

// At an end of the range the acceleration may be larger.
TEST(TipReading, IsEmptyAtAnEndOfTheRange) {
  EXPECT_FALSE(TipReading(Frame(2047), kConfig).has_value());
  EXPECT_FALSE(TipReading(Frame(-2048), kConfig).has_value());
  EXPECT_TRUE(TipReading(Frame(2046), kConfig).has_value());
  EXPECT_TRUE(TipReading(Frame(-2047), kConfig).has_value());
}

}  // namespace
}  // namespace flexarm
