#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/tools/status/watched.h"
#include "tools/status/arm_drawing.h"
#include "tools/status/display_text.h"
#include "tools/status/gauge_bar.h"

namespace flexarm {
namespace {

std::string Plain(const StyledRow& row) { return row.Text(200, kPlainUtf8); }
std::string Coloured(const StyledRow& row) { return row.Text(200, {.colour = true, .utf8 = true}); }

TEST(DisplayText, WidthsAreThoseOfTheTerminal) {
  EXPECT_EQ(DisplayWidth(""), 0);
  EXPECT_EQ(DisplayWidth("abc"), 3);
  EXPECT_EQ(DisplayWidth("Pr\xC3\xBC"
                         "f"),
            4)
      << "two bytes, one column";
  EXPECT_EQ(DisplayWidth("e\xCC\x81"), 1) << "an accent on the sign before it";
  EXPECT_EQ(DisplayWidth("\xE8\x87\x82"), 2) << "a Chinese sign";
  EXPECT_EQ(DisplayWidth("\xE2\xA3\xBF"), 1) << "a Braille sign";
  EXPECT_EQ(DisplayWidth("a\xFF\xE8\x87"), 4) << "bytes that are no UTF-8";
}

TEST(DisplayText, NoSignIsCut) {
  EXPECT_EQ(Clipped("abc", 2), "ab");
  EXPECT_EQ(Clipped("a\xE8\x87\x82", 2), "a") << "half a sign does not fit";
  EXPECT_EQ(Clipped("a\xE8\x87\x82", 3), "a\xE8\x87\x82");
  EXPECT_EQ(Clipped("e\xCC\x81x", 1), "e\xCC\x81");
  EXPECT_EQ(InAscii("\xC3\xBC\xE8\x87\x82"), "???") << "as wide as before";
}

TEST(StyledRow, EachPartEndsItsColour) {
  StyledRow row("a");
  row.Add("b", Look::kBad).Add("c");
  EXPECT_EQ(Coloured(row), "a\033[1;7mb\033[0mc");
  EXPECT_EQ(Plain(row), "abc");
  EXPECT_EQ(row.Text(1, kPlainUtf8), "a");
}

TEST(StyledRow, ItemsFlowIntoTheRowsThatTheyNeed) {
  const Rows items{StyledRow("aaaa"), StyledRow("bb"), StyledRow("cccc")};
  const Rows rows = Flow(items, 9);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(Plain(rows[0]), "aaaa  bb");
  EXPECT_EQ(Plain(rows[1]), "  cccc");
}

TEST(StyledRow, WordsWrapWhereTheyMust) {
  const Rows rows = WrapWords("one two  three", 7);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(Plain(rows[0]), "one two");
  EXPECT_EQ(Plain(rows[1]), "three");
  EXPECT_TRUE(WrapWords("", 7).empty());
}

TEST(GaugeBar, ShowsSignShareAndLimit) {
  EXPECT_EQ(Plain(GaugeBar(0.0, 10.0, 13)), "[     |     ]");
  EXPECT_EQ(Plain(GaugeBar(4.0, 10.0, 13)), "[     |==   ]");
  EXPECT_EQ(Plain(GaugeBar(-10.0, 10.0, 13)), "[=====|     ]");
  EXPECT_EQ(Plain(GaugeBar(10.1, 10.0, 13)), "[     |====>]");
  EXPECT_EQ(Plain(GaugeBar(-1e300, 10.0, 13)), "[<====|     ]");
}

TEST(GaugeBar, ItsLookIsACautionFrom80PercentAndBadBeyond) {
  EXPECT_THAT(Coloured(GaugeBar(7.9, 10.0, 13)), testing::HasSubstr("\033[36m"));
  EXPECT_THAT(Coloured(GaugeBar(-8.0, 10.0, 13)), testing::HasSubstr("\033[1;33m"));
  EXPECT_THAT(Coloured(GaugeBar(10.1, 10.0, 13)), testing::HasSubstr("\033[1;7m"));
}

TEST(GaugeBar, WhatIsNotKnownIsEmpty) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Plain(GaugeBar(kNan, 10.0, 7)), "[  |  ]");
  EXPECT_EQ(Plain(GaugeBar(3.0, kNan, 7)), "[  |  ]");
  EXPECT_EQ(Plain(GaugeBar(3.0, 0.0, 7)), "[  |  ]");
  EXPECT_EQ(GaugeBar(3.0, 10.0, 4).width(), 0) << "no room";
}

TEST(GaugeBar, IsAsWideAsItIsTold) {
  for (int columns = 5; columns < 60; ++columns) {
    EXPECT_EQ(GaugeBar(3.0, 10.0, columns).width(), columns);
    EXPECT_EQ(ShareBar(0.4, columns).width(), columns);
  }
  EXPECT_EQ(Plain(ShareBar(0.4, 7)), "[##...]");
  EXPECT_EQ(Plain(ShareBar(7.0, 7)), "[#####]");
}

TEST(AgeText, HasAUnitThatSuits) {
  EXPECT_EQ(AgeText(41.5e-6), "42 us");
  EXPECT_EQ(AgeText(0.0023), "2.3 ms");
  EXPECT_EQ(AgeText(0.0354), "35 ms");
  EXPECT_EQ(AgeText(3.21), "3.2 s");
  EXPECT_EQ(AgeText(720.0), "12 min");
}

/// Where a sign is: column and row.
std::pair<int, int> PlaceOf(char sign, const Rows& rows) {
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::string line = Plain(rows[row]);
    const std::size_t at = line.find(sign);
    if (at != std::string::npos) {
      return {DisplayWidth(line.substr(0, at)), static_cast<int>(row)};
    }
  }
  return {-1, -1};
}

ArmPose Pose(double angle_1_rad, double angle_2_rad, double bending_m = 0.0) {
  return {.length_m = {0.8, 0.9},
          .angle_rad = {angle_1_rad, angle_2_rad},
          .bending_m = {bending_m, 0.0}};
}

TEST(ArmDrawing, ZeroIsAheadAndPositiveTurnsLeft) {
  constexpr int kColumns = 41, kRows = 21;
  for (const bool utf8 : {false, true}) {
    const Rows straight = ArmDrawing(Pose(0.0, 0.0), kColumns, kRows, utf8);
    ASSERT_EQ(straight.size(), std::size_t{kRows});
    const auto [base_column, base_row] = PlaceOf('O', straight);
    const auto [tip_column, tip_row] = PlaceOf('x', straight);
    EXPECT_EQ(tip_column, base_column);
    EXPECT_LT(tip_row, base_row);
    const Rows left = ArmDrawing(Pose(M_PI / 2.0, 0.0), kColumns, kRows, utf8);
    EXPECT_EQ(PlaceOf('x', left).second, PlaceOf('O', left).second);
    EXPECT_LT(PlaceOf('x', left).first, PlaceOf('o', left).first);
    EXPECT_LT(PlaceOf('o', left).first, PlaceOf('O', left).first);
    const Rows back = ArmDrawing(Pose(M_PI / 2.0, M_PI / 2.0), kColumns, kRows, utf8);
    EXPECT_GT(PlaceOf('x', back).second, PlaceOf('o', back).second) << "the elbow turns on";
  }
}

TEST(ArmDrawing, BendingIsDrawnLargerThanItIs) {
  const Rows straight = ArmDrawing(Pose(0.0, 0.0), 41, 21, true);
  const Rows bent = ArmDrawing(Pose(0.0, 0.0, 0.05), 41, 21, true);
  // 41 columns are four lengths of 1.7 m, less 5 %: 0.25 m, five times 0.05 m, are 2.9 columns.
  EXPECT_NEAR(PlaceOf('o', straight).first - PlaceOf('o', bent).first, 2.9, 1.0);
}

TEST(ArmDrawing, StaysWithinItsRoomWhateverThePose) {
  for (const double wild : {0.0, 1.0, -3.0, 1e300, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()}) {
    const Rows rows =
        ArmDrawing({.length_m = {0.8, wild}, .angle_rad = {wild, 0.3}, .bending_m = {wild, wild}},
                   20, 9, true);
    ASSERT_EQ(rows.size(), 9u);
    for (const StyledRow& row : rows) EXPECT_EQ(row.width(), 20);
  }
  EXPECT_TRUE(ArmDrawing(Pose(0.0, 0.0), 0, 5, true).empty());
}

}  // namespace
}  // namespace flexarm
