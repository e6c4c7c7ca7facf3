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

TEST(RestMeterTest, MeansAndDeviationsAreThoseOfTheReadings) {
  RestMeter meter(4);
  EXPECT_FALSE(meter.started());
  for (const std::int32_t strain : {-4, 8, -4, 8}) {
    TickRecord tick = Tick(0, strain, true);
    tick.input.frame.strain[1] = 7;
    tick.input.frame.strain_valid = 0b11;
    meter.Take(tick);
    EXPECT_TRUE(meter.started());
  }
  const RestReadings readings = meter.Result();
  EXPECT_EQ(readings.strain_mean[0], 2.0);
  EXPECT_EQ(readings.strain_sigma[0], 6.0);
  EXPECT_EQ(readings.strain_mean[1], 7.0);
  EXPECT_EQ(readings.strain_sigma[1], 0.0);
}

TEST(RestMeterTest, OneReadingIsAMean) {
  RestMeter meter(2);
  meter.Take(Tick(50, 9, true));
  meter.Take(Tick(0, 0, false));
  const RestReadings readings = meter.Result();
  EXPECT_EQ(readings.strain_mean[0], 9.0);
  EXPECT_EQ(readings.strain_missing[0], 1);
  EXPECT_EQ(readings.travel_counts[0], 0);
  EXPECT_EQ(readings.counts[0], 50);
}

TEST(RestMeterTest, TheTravelIsFromTheLowestToTheHighestCount) {
  RestMeter meter(3);
  for (const std::int64_t counts : {-101, -98, -103}) {
    TickRecord tick = Tick(counts, 0, true);
    tick.output.counters_used = 0xFFFFFFFFU;  // also bits of counters that there are not
    meter.Take(tick);
  }
  const RestReadings readings = meter.Result();
  for (const std::int64_t travel : readings.travel_counts) EXPECT_EQ(travel, 5);
  for (const int missing : readings.counter_missing) EXPECT_EQ(missing, 0);
}

}  // namespace
}  // namespace flexarm
