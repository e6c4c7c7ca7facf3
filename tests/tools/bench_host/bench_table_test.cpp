#include "tools/bench_host/bench_table.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace flexarm {
namespace {

BenchReport Report(std::vector<BenchRow> rows) {
  return {.quick = false,
          .config = "rig.toml",
          .machine = {.processor = "Processor | X",
                      .cores = 2,
                      .is_virtual = true,
                      .kernel = "Linux 6",
                      .governor = "performance",
                      .load = 0.0,
                      .processor_share = 1.0,
                      .compiler = "GNU 12",
                      .build_type = "Release",
                      .build = "abc"},
          .bounds = {{.name = "narrow", .what = "narrow registers", .flops_per_s = 1e9},
                     {.name = "wide", .what = "wide registers", .flops_per_s = 4e9}},
          .rows = std::move(rows)};
}

// 1 ms for 1,200,000 operations: 1.2 Gflop/s, 30 % of the wider bound.
BenchRow Counted() {
  return {.name = "row",
          .what = "A row",
          .time = TimingOf({1e-3, 1e-3, 1e-3}),
          .work = WorkCount{.flops = 1'200'000, .instructions = 3'000'000},
          .counted = kSingleStepped,
          .ratio = BenchRatio{.name = "speed", .unit = "times the other", .value = 2.5, .bar = 3.0},
          .result = "more"};
}

TEST(BenchTable, ShowsTheShareOfTheHighestBound) {
  const std::string page = BenchMarkdown(Report({Counted()}));
  EXPECT_NE(page.find("| A row | 1 ms (1 ms to 1 ms, 3) | 1,200,000 | 1.20 | 30.0 % | "
                      "**2.5** times the other (bar 3: MISSED); more |"),
            std::string::npos)
      << page;
  EXPECT_TRUE(page.starts_with(kBenchHostMark));
  EXPECT_NE(page.find("Processor / X, virtual, 2 cores"), std::string::npos) << page;
  EXPECT_EQ(page.find("Warning"), std::string::npos) << page;
}

TEST(BenchTable, ARowThatWasNotMeasuredSaysWhyAndHasNoNumbers) {
  const BenchReport report = Report({NotMeasured("row", "A row", "no tool: install it")});
  EXPECT_NE(BenchMarkdown(report).find("| A row |  |  |  |  | not measured: no tool: install it |"),
            std::string::npos);
  const nlohmann::ordered_json row = BenchJson(report)["rows"][0];
  EXPECT_EQ(row["not_measured"], "no tool: install it");
  for (const char* key : {"median_s", "flops", "bound_share", "ratio", "ratio_bar"}) {
    EXPECT_TRUE(row[key].is_null()) << key;
  }
}

TEST(BenchTable, JsonHasTheNumbers) {
  const nlohmann::ordered_json json = BenchJson(Report({Counted()}));
  const nlohmann::ordered_json row = json["rows"][0];
  EXPECT_DOUBLE_EQ(row["median_s"].get<double>(), 1e-3);
  EXPECT_EQ(row["flops"], 1'200'000);
  EXPECT_NEAR(row["bound_share"].get<double>(), 0.3, 1e-12);
  EXPECT_NEAR(row["flops_per_s"].get<double>(), 1.2e9, 1.0);
  EXPECT_EQ(row["ratio_of"], "speed");
  EXPECT_EQ(row["ratio_bar"], 3.0);
  EXPECT_TRUE(row["not_measured"].is_null());
  EXPECT_EQ(json["bounds"].size(), 2U);
  EXPECT_EQ(json["build"], "abc");
}

TEST(BenchTable, ReachedIsFromTheBarOn) {
  BenchRow row = Counted();
  row.ratio->value = 3.0;
  EXPECT_NE(BenchMarkdown(Report({row})).find("(bar 3: reached)"), std::string::npos);
}

TEST(BenchTable, ACountIsNeededForAShare) {
  BenchRow row = Counted();
  row.work.reset();
  row.counted = "not counted: no permission";
  EXPECT_FALSE(BoundShare(row, 1e9));
  EXPECT_NE(BenchMarkdown(Report({row})).find("more; not counted: no permission |"),
            std::string::npos);
}

TEST(BenchTable, DurationsHaveThreeDigitsAndTheirUnit) {
  EXPECT_EQ(DurationText(1.234e-9), "1.23 ns");
  EXPECT_EQ(DurationText(15.46e-6), "15.5 us");
  EXPECT_EQ(DurationText(0.99996e-3), "1 ms");
  EXPECT_EQ(DurationText(2.0), "2 s");
  EXPECT_EQ(DurationText(0.0), "0 ns");
}

}  // namespace
}  // namespace flexarm
