#include "estimator/counter_decoder.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <cstdlib>

#include "model/units.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

// One encoder on hub 1: 1000 counts a turn, so a period at 14 rad/s is 44.6 counts.
SensorConfig OneEncoder(int bits, int sign = 1) {
  SensorConfig sensors{};
  sensors.encoder = {{.counter = 0, .counts_per_turn = 1000.0, .counter_bits = bits, .sign = sign}};
  return sensors;
}

SensorFrame Reading(std::int64_t count, int bits) {
  SensorFrame frame{};
  frame.counter[0] = static_cast<std::uint32_t>(count & ((std::int64_t{1} << bits) - 1));
  frame.counter_valid = 1;
  return frame;
}

SensorFrame NoReading() { return SensorFrame{}; }

double Rate(double counts_per_period) { return counts_per_period / 1000.0 * kTwoPi / kPeriod_s; }

class Width : public testing::TestWithParam<int> {};

// Three turns one way and six back: 8 bits overflow a dozen times, 16 bits below zero.
TEST_P(Width, ManyTurnsAndOverflowsAreCountedBothWays) {
  const int bits = GetParam();
  for (const int sign : {1, -1}) {
    CounterDecoder decoder(OneEncoder(bits, sign), kPeriod_s, Rate(60.0));
    std::int64_t count = 0;
    for (int k = 0; k < 180; ++k) {
      count += k < 60 ? 50 : -50;
      const DecodedCounters out = decoder.Decode(Reading(count, bits));
      ASSERT_EQ(out.good, 1u);
      ASSERT_EQ(out.counts[0], count);
      EXPECT_DOUBLE_EQ(out.angle_rad[0], sign * static_cast<double>(count) * kTwoPi / 1000.0);
      EXPECT_NEAR(out.rate_rad_s[0], sign * (k < 60 ? 1 : -1) * Rate(50.0), 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bits, Width, testing::Values(8, 16, 32));

// Any random walk whose steps stay below half the counter's range is decoded exactly.
TEST(CounterDecoder, ARandomWalkBelowHalfTheRangeIsDecodedExactly) {
  setenv("RC_PARAMS", "seed=20261120 max_success=2000", 0);  // repeatable
  EXPECT_TRUE(rc::check("random walk", [] {
    const int bits = *rc::gen::element(8, 10, 16);
    const int half = (1 << (bits - 1)) - 1;
    const auto steps = *rc::gen::container<std::vector<int>>(rc::gen::inRange(-half, half + 1));
    CounterDecoder decoder(OneEncoder(bits), kPeriod_s, Rate(half + 0.5));
    std::int64_t count = 0;
    for (const int step : steps) {
      count += step;
      const DecodedCounters out = decoder.Decode(Reading(count, bits));
      RC_ASSERT(out.good == 1u);
      RC_ASSERT(out.counts[0] == count);
    }
  }));
}

// At 100 counts a period an 8-bit counter moves 200 over one missed reading, more than half its
// range: only the extrapolated rate distinguishes 200 from -56.
TEST(CounterDecoder, AMissingReadingAtHighRateLosesNoCount) {
  for (const int direction : {1, -1}) {
    CounterDecoder decoder(OneEncoder(8), kPeriod_s, Rate(110.0));
    std::int64_t count = 0;
    for (int k = 0; k < 3; ++k) decoder.Decode(Reading(count += direction * 100, 8));
    count += direction * 100;
    const DecodedCounters missed = decoder.Decode(NoReading());
    EXPECT_EQ(missed.good, 0u);
    EXPECT_EQ(missed.jumped, 0u);
    EXPECT_EQ(missed.missing_ticks[0], 1);
    EXPECT_EQ(missed.counts[0], direction * 300) << "the last good value stays";
    const DecodedCounters back = decoder.Decode(Reading(count += direction * 100, 8));
    EXPECT_EQ(back.good, 1u);
    EXPECT_EQ(back.counts[0], direction * 500);
    EXPECT_EQ(back.missing_ticks[0], 0);
    EXPECT_NEAR(back.rate_rad_s[0], direction * Rate(100.0), 1e-9) << "mean over both periods";
  }
}

TEST(CounterDecoder, AnImpossibleJumpIsReportedAndRejected) {
  CounterDecoder decoder(OneEncoder(16), kPeriod_s, Rate(45.0));
  decoder.Decode(Reading(10, 16));
  const DecodedCounters out = decoder.Decode(Reading(10 + 46, 16));
  EXPECT_EQ(out.jumped, 1u);
  EXPECT_EQ(out.good, 0u);
  EXPECT_EQ(out.counts[0], 10);
  EXPECT_EQ(out.missing_ticks[0], 1);
  // The next reading is plausible again.
  const DecodedCounters next = decoder.Decode(Reading(12, 16));
  EXPECT_EQ(next.good, 1u);
  EXPECT_EQ(next.jumped, 0u);
  EXPECT_EQ(next.counts[0], 12);
}

TEST(CounterDecoder, TheFastestPossibleChangeIsNoJump) {
  CounterDecoder decoder(OneEncoder(16), kPeriod_s, Rate(45.5));
  EXPECT_EQ(decoder.Decode(Reading(45, 16)).good, 1u);
  EXPECT_EQ(decoder.Decode(Reading(0, 16)).good, 1u);
}

TEST(CounterDecoder, ResetStartsFromTheGivenCounts) {
  CounterDecoder decoder(OneEncoder(8), kPeriod_s, Rate(60.0));
  decoder.Reset({1'000'000, 0, 0, 0}, {});
  const DecodedCounters out = decoder.Decode(Reading(1'000'020, 8));
  EXPECT_EQ(out.counts[0], 1'000'020);
  EXPECT_EQ(out.good, 1u);
}

TEST(CounterDecoder, AnglesAreRelativeToTheGivenZero) {
  CounterDecoder decoder(OneEncoder(8), kPeriod_s, Rate(60.0));
  decoder.Reset({1000, 0, 0, 0}, {700, 0, 0, 0});
  const DecodedCounters out = decoder.Decode(Reading(1010, 8));
  EXPECT_EQ(out.counts[0], 1010) << "counts are raw";
  EXPECT_NEAR(out.angle_rad[0], 310.0 * 2.0 * M_PI / 1000.0, 1e-12);
}

TEST(CounterDecoder, ResetClearsTheRate) {
  CounterDecoder decoder(OneEncoder(8), kPeriod_s, Rate(110.0));
  for (int k = 1; k <= 3; ++k) decoder.Decode(Reading(100 * k, 8));
  decoder.Reset({300, 0, 0, 0}, {});
  decoder.Decode(NoReading());
  // At rest since the reset: without a rate, 310 after a miss is 310.
  EXPECT_EQ(decoder.Decode(Reading(310, 8)).counts[0], 310);
}

TEST(CounterDecoder, AnAbsentEncoderIsNeverGoodAndReadsZero) {
  CounterDecoder decoder(OneEncoder(8), kPeriod_s, Rate(60.0));
  SensorFrame frame = Reading(5, 8);
  frame.counter = {5, 7, 7, 7};
  frame.counter_valid = 0b1111;
  const DecodedCounters out = decoder.Decode(frame);
  EXPECT_EQ(out.good, 1u);
  EXPECT_EQ(out.jumped, 0u);
  EXPECT_EQ(out.angle_rad[2], 0.0);
}

}  // namespace
}  // namespace flexarm
