#include "tools/trip_report/signal_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace flexarm {
namespace {

constexpr double kSample_s = 0.02;

TEST(SignalRows, AShortSpanKeepsEverySampleAndLeavesAGapOpen) {
  SignalRows rows(1, -1.0, 1.0, kSample_s, 1000);
  rows.Add(-1.5, {7.0});  // outside
  rows.Add(0.0, {1.0});
  rows.Add(0.02, {2.0});
  rows.Add(0.10, {3.0});  // three samples are missing
  rows.Add(1.5, {7.0});
  rows.Finish();
  ASSERT_EQ(rows.time_s().size(), 4U);
  EXPECT_EQ(rows.value(0)[1], 2.0);
  EXPECT_TRUE(std::isnan(rows.value(0)[2]));
  EXPECT_EQ(rows.value(0)[3], 3.0);
}

TEST(SignalRows, AnHourHasFewRowsAndLosesNoPeak) {
  constexpr std::size_t kMost = 600, kSamples = 180'000, kPeak = 123'456;
  SignalRows rows(2, 0.0, kSamples * kSample_s, kSample_s, kMost);
  for (std::size_t i = 0; i < kSamples; ++i) {
    rows.Add(kSample_s * static_cast<double>(i), {i == kPeak ? -9.0 : 0.0, i == kPeak ? 9.0 : 1.0});
  }
  rows.Finish();
  EXPECT_LE(rows.time_s().size(), kMost);
  EXPECT_TRUE(std::ranges::is_sorted(rows.time_s()));
  EXPECT_EQ(std::ranges::min(rows.value(0)), -9.0);
  EXPECT_EQ(std::ranges::max(rows.value(1)), 9.0);
  const auto at = std::ranges::find(rows.value(1), 9.0) - rows.value(1).begin();
  // Two rows a part: a part of the time axis is 2 / kMost of it.
  EXPECT_NEAR(rows.time_s()[static_cast<std::size_t>(at)], kSample_s * kPeak,
              2.0 / kMost * kSamples * kSample_s);
}

TEST(SignalRows, AValueThatIsNotKnownHidesNoOther) {
  SignalRows rows(1, 0.0, 100.0, kSample_s, 10);
  for (int i = 0; i < 5000; ++i) {
    rows.Add(kSample_s * i, {i % 2 == 0 ? std::nan("") : 4.0});
  }
  rows.Finish();
  for (const double value : rows.value(0)) EXPECT_EQ(value, 4.0);
}

}  // namespace
}  // namespace flexarm
