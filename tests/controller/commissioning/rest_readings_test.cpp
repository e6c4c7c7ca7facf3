#include "controller/commissioning/rest_readings.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

TickRecord Tick(std::int64_t counts, std::int32_t strain, bool read) {
  TickRecord tick{};
  tick.output.counts.fill(counts);
  tick.output.counters_used = read ? 0b1111u : 0u;
  tick.input.frame.strain[0] = strain;
  tick.input.frame.strain_valid = read ? 1u : 0u;
  return tick;
}

TEST(RestMeterTest, LeavesOutSamplesThatWereNotRead) {
  RestMeter meter(4);
  EXPECT_FALSE(meter.Take(Tick(999, 999, false)));
  EXPECT_FALSE(meter.Take(Tick(100, 5, true)));
  EXPECT_FALSE(meter.Take(Tick(102, 7, true)));
  EXPECT_TRUE(meter.Take(Tick(-999, -999, false)));
  const RestReadings readings = meter.Result();
  EXPECT_EQ(readings.ticks, 4);
  EXPECT_EQ(readings.counter_missing[3], 2);
  EXPECT_EQ(readings.travel_counts[3], 2);
  EXPECT_EQ(readings.counts[3], 102);
  EXPECT_EQ(readings.strain_missing[0], 2);
  EXPECT_EQ(readings.strain_mean[0], 6.0);
  EXPECT_EQ(readings.strain_missing[1], 4);
}

}  // namespace
}  // namespace flexarm
