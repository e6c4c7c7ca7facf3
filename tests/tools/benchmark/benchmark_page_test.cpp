// The text tables of the benchmark.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/tools/benchmark/benchmark_rows.h"
#include "tools/benchmark/benchmark.h"

namespace flexarm {
namespace {

TEST(BenchmarkPage, ShowsNotSettledAndTheNumberOfCompletedRuns) {
  const SweepPlan plan = Plan("sobel", "1..2");
  std::vector<SweepRow> rows = {Made(0, std::nan("")), Made(1, std::nan(""))};
  rows[1].completed = false;
  const std::string page = BenchmarkMarkdown(Table(plan, rows));
  EXPECT_NE(page.find("not settled (1/2)"), std::string::npos) << page;
}

// The rests of random moves last 1.5 s; the runs settle at once, after 0.3 and after 0.32 s.
TEST(BenchmarkPage, OfTheMovesCountsTheRunsThatSettledInTime) {
  const SweepPlan plan = Plan("sobel", "1..5", BenchmarkKind::kMoves);
  const BenchmarkTable table = Table(plan, FiveRuns(), BenchmarkKind::kMoves);
  EXPECT_NEAR(table.cell[0][0].score, 100.0 * (1.0 + 1.18 / 1.5 + 1.2 / 1.5) / 5.0, 1e-12);
  const std::string page = BenchmarkMarkdown(table);
  EXPECT_NE(page.find("| nominal | 0 to 1 kg | 2/5, 1.2 (4/5) |"), std::string::npos) << page;
  EXPECT_NE(page.find("| 2/5 | not settled | 7.0 | 1.2 2.0 | 2.0 5.0 | 1.50 3.00 |"),
            std::string::npos)
      << page;
}

// Two of three completed runs have all moves at rest; their means are 2.5 and 1.4, on target one's.
TEST(BenchmarkPage, OfTheFastMovesHasTheTimesOverTheBound) {
  const SweepPlan plan = Plan("gain-scheduled", "1..4", BenchmarkKind::kFast);
  std::vector<SweepRow> rows = {Made(0, 0.1), Made(1, 0.1), Made(2, 0.1), Made(3, 0.1)};
  rows[0].measure[kFirstAtRest] = 2.0;
  rows[0].measure[kLaterAtRest] = 1.3;
  rows[1].measure[kFirstAtRest] = 3.0;
  rows[1].measure[kLaterAtRest] = std::nan("");
  rows[2].measure[kFirstAtRest] = 2.5;
  rows[2].measure[kLaterAtRest] = 1.5;
  rows[2].measure[kLaterOnTarget] = std::nan("");
  rows[3].completed = false;
  const std::string page = BenchmarkMarkdown(Table(plan, rows, BenchmarkKind::kFast));
  EXPECT_NE(page.find("| 2/4 | 2.50 | 1.40 | 2/4 | 1.00 | 1.00 |"), std::string::npos) << page;
  EXPECT_NE(page.find("| nominal | 0 to 1 kg | 2/4, 2.50 1.40 (3/4) |"), std::string::npos) << page;
}

using Cells = std::vector<std::string>;

TEST(BenchmarkPage, OfTheCommandsHasARowPerLawAndARowPerScenario) {
  const SweepPlan plan = Plan("sobel,pd", "1");
  const BenchmarkTable table = Table(plan, OneEach(plan));
  const std::vector<TablePart> parts = TableParts(table);
  ASSERT_EQ(parts.size(), 2U);
  const std::string all = std::to_string(plan.scenarios.size());
  const auto score = [&table](std::size_t law) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%.1f", table.Score(law));
    return std::string(text.data());
  };
  const auto& laws = parts[0].table;
  ASSERT_EQ(laws.rows.size(), 2U);
  EXPECT_EQ(laws.rows[0], (Cells{"sobel", score(0), "0.0", plan.scenarios[3].name,
                                 std::to_string(plan.scenarios.size() - 1) + "/" + all, "0.70",
                                 "1.00 2.00", "3.00 4.00", "12.0", "6.0", "9.00 10.00"}));
  EXPECT_EQ(laws.rows[1], (Cells{"pd", score(1), "25.0", "waypoints", all + "/" + all, "1.40",
                                 "11.00 12.00", "13.00 14.00", "22.0", "16.0", "19.00 20.00"}));
  const auto& scenarios = parts[1].table;
  EXPECT_EQ(scenarios.head, (Cells{"scenario", "what", "sobel", "pd"}));
  ASSERT_EQ(scenarios.rows.size(), plan.scenarios.size());
  EXPECT_EQ(scenarios.rows[0],
            (Cells{"nominal", "0.1 kg, as designed for (tuned on)", "0.70", "1.40"}));
  EXPECT_EQ(scenarios.rows[3][2], "- (0/1)");
  EXPECT_EQ(scenarios.rows[9], (Cells{"waypoints", "smooth moves", "0.70", "4.80"}));
  const std::string page = BenchmarkMarkdown(table);
  EXPECT_NE(page.find("| scenario | what | sobel | pd |\n|---|---|---|---|\n| nominal |"),
            std::string::npos)
      << page;
}

// Only runs that settle within 0.3 s are in time: none of these.
TEST(BenchmarkPage, OfTheMovesAndTheLimitsHasTheFiguresOfTheRests) {
  const SweepPlan moves = Plan("sobel,pd", "1", BenchmarkKind::kMoves);
  std::vector<SweepRow> rows = OneEach(moves);
  for (std::size_t i = 1; i < 3; ++i) rows[i].measure[kSettling] = 0.2;  // two runs of sobel
  const std::vector<TablePart> parts = TableParts(Table(moves, rows, BenchmarkKind::kMoves));
  ASSERT_EQ(parts.size(), 2U);
  const std::string all = std::to_string(moves.scenarios.size());
  const auto without_score = [&parts](std::size_t law) {
    Cells cells = parts[0].table.rows.at(law);
    cells.erase(cells.begin() + 1);
    return cells;
  };
  EXPECT_EQ(without_score(0),
            (Cells{"sobel", std::to_string(moves.scenarios.size() - 1) + "/" + all, "2/" + all,
                   "0/1", "0.70", "12.0", "6.0 6.0", "11.0 11.0", "1.00 2.00"}));
  EXPECT_EQ(without_score(1), (Cells{"pd", all + "/" + all, "0/" + all, "0/1", "1.40", "22.0",
                                     "16.0 16.0", "21.0 21.0", "11.00 12.00"}));
  EXPECT_EQ(parts[1].table.rows[3][2], "0/1, - (0/1)");
  EXPECT_EQ(parts[1].table.rows[3][3], "0/1, 16.0");

  const SweepPlan limits = Plan("sobel,pd", "1", BenchmarkKind::kLimits);
  const std::vector<TablePart> limit_parts =
      TableParts(Table(limits, OneEach(limits), BenchmarkKind::kLimits));
  ASSERT_EQ(limit_parts.size(), 1U);
  const auto& of_limits = limit_parts[0].table.rows;
  ASSERT_EQ(of_limits.size(), 2 * limits.scenarios.size());
  EXPECT_EQ(of_limits[2], (Cells{limits.scenarios[1].name, limits.scenarios[1].what, "sobel", "0/1",
                                 "0.70", "12.0", "6.0 6.0", "11.0 11.0", "1.00 2.00"}));
  EXPECT_EQ(of_limits[3], (Cells{limits.scenarios[1].name, limits.scenarios[1].what, "pd", "0/1",
                                 "1.40", "22.0", "16.0 16.0", "21.0 21.0", "11.00 12.00"}));
}

// The refusal of one seed does not hide the results of the others.
TEST(BenchmarkPage, ShowsTheOtherSeedsIfOneWasRefused) {
  const SweepPlan plan = Plan("sobel", "1..2", BenchmarkKind::kMoves);
  const std::string page = BenchmarkMarkdown(
      Table(plan, {RefusedRow(0, "a move is too short"), Made(1, 0.1)}, BenchmarkKind::kMoves));
  EXPECT_NE(page.find("| nominal | 0 to 1 kg | 1/2, 1.0 (1/2) |"), std::string::npos) << page;
}

TEST(BenchmarkPage, ShowsRefusedIfNoRunWasMade) {
  const SweepPlan plan = Plan("sobel", "1", BenchmarkKind::kMoves);
  const std::string page =
      BenchmarkMarkdown(Table(plan, {RefusedRow(0, "a move is too short")}, BenchmarkKind::kMoves));
  EXPECT_NE(page.find("| nominal | 0 to 1 kg | refused |"), std::string::npos) << page;
}

}  // namespace
}  // namespace flexarm
