#include "controller/safety/line_filter.h"

#include <gtest/gtest.h>

#include <vector>

#include "hal/line_names.h"

namespace flexarm {
namespace {

constexpr LineLevels kButton = LineBit(Line::kResetButton);
constexpr int kSamples = 10;

// Bit i of `sequence` is the sample of tick i.
bool Closed(unsigned sequence, int tick) { return tick >= 0 && (sequence >> tick & 1U) != 0; }

// Every sequence of 10 samples, on each switch, while the other lines do the opposite.
TEST(LineFilter, ASwitchIsWhatTwoOfItsLastThreeSamplesSay) {
  for (int i = 0; i < kLines - 1; ++i) {
    const LineLevels line = LineBit(static_cast<Line>(i));
    for (unsigned sequence = 0; sequence < 1U << kSamples; ++sequence) {
      LineFilter filter;
      for (int tick = 0; tick < kSamples; ++tick) {
        const bool closed = Closed(sequence, tick);
        const LineLevels levels = filter.Next(closed ? line : kHealthyLevels & ~line);
        const int votes = (closed ? 1 : 0) + (Closed(sequence, tick - 1) ? 1 : 0) +
                          (Closed(sequence, tick - 2) ? 1 : 0);
        ASSERT_EQ((levels & line) != 0, votes >= 2)
            << ToString(static_cast<Line>(i)) << ", samples " << sequence << ", tick " << tick;
      }
    }
  }
}

TEST(LineFilter, OneSampleChangesNothingAndTheSecondDoes) {
  LineFilter filter;
  for (int tick = 0; tick < 3; ++tick) filter.Next(kHealthyLevels);
  EXPECT_EQ(filter.Next(0), kHealthyLevels);
  EXPECT_EQ(filter.Next(kHealthyLevels), kHealthyLevels);
  EXPECT_EQ(filter.Next(kHealthyLevels), kHealthyLevels);
  EXPECT_EQ(filter.Next(0), kHealthyLevels);
  EXPECT_EQ(filter.Next(0), 0U);
  EXPECT_EQ(filter.Next(kHealthyLevels), 0U) << "closing needs two samples as well";
  EXPECT_EQ(filter.Next(kHealthyLevels), kHealthyLevels);
}

// A contact that chatters: open in every second sample.
TEST(LineFilter, AChatteringContactOpensWithinThreeSamples) {
  LineFilter filter;
  for (int tick = 0; tick < 3; ++tick) filter.Next(kHealthyLevels);
  EXPECT_EQ(filter.Next(0), kHealthyLevels);
  EXPECT_EQ(filter.Next(kHealthyLevels), kHealthyLevels);
  EXPECT_EQ(filter.Next(0), 0U);
}

TEST(LineFilter, BeforeTheThirdSampleASwitchIsUnknownAndCountsAsOpen) {
  LineFilter filter;
  EXPECT_FALSE(filter.known());
  EXPECT_EQ(filter.Next(kHealthyLevels), 0U);
  EXPECT_FALSE(filter.known());
  EXPECT_EQ(filter.Next(0), 0U);
  EXPECT_FALSE(filter.known());
  EXPECT_EQ(filter.Next(kHealthyLevels), kHealthyLevels);
  EXPECT_TRUE(filter.known());
  for (int tick = 0; tick < 10; ++tick) {
    filter.Next(0);
    EXPECT_TRUE(filter.known());
  }
}

// Released once, then pressed for so many samples, then released.
TEST(LineFilter, TheButtonCountsFromItsFiftiethSampleInARowUntilOneIsReleased) {
  for (int pressed = 0; pressed < 120; ++pressed) {
    LineFilter filter;
    EXPECT_EQ(filter.Next(0) & kButton, 0U);
    for (int sample = 1; sample <= pressed; ++sample) {
      ASSERT_EQ((filter.Next(kButton) & kButton) != 0, sample >= 50) << sample;
    }
    EXPECT_EQ(filter.Next(0) & kButton, 0U);
  }
}

TEST(LineFilter, AButtonThatBouncesBeginsAgain) {
  LineFilter filter;
  filter.Next(0);
  for (int bounce = 0; bounce < 10; ++bounce) {
    for (int sample = 0; sample < 49; ++sample) ASSERT_EQ(filter.Next(kButton) & kButton, 0U);
    ASSERT_EQ(filter.Next(0) & kButton, 0U);
  }
}

TEST(LineFilter, AButtonThatIsDownFromTheStartIsPressedSoItsEdgeIsNeverSeen) {
  LineFilter filter;
  for (int tick = 0; tick < 100; ++tick) ASSERT_NE(filter.Next(kButton) & kButton, 0U) << tick;
}

static_assert(LineFilter{}.Next(kHealthyLevels) == 0);
static_assert(LineFilter::kPressNs == 50'000'000);

}  // namespace
}  // namespace flexarm
