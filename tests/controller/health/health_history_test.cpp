#include "controller/health/health_history.h"

#include <gtest/gtest.h>

#include "controller/files/input_error.h"
#include "controller/health/drift_trend.h"

namespace flexarm {
namespace {

const std::vector<DriftChannel> kTwoChannels = {
    {.kind = DriftKind::kGaugeGain, .part = 1, .gauge = 1, .strain = 0},
    {.kind = DriftKind::kPayload, .part = 0, .gauge = 0, .strain = 0}};

HealthRecord RunOf(const std::string& name, std::uint64_t plant = 7) {
  return {.run = name,
          .start_utc = "2026-10-01T00:00:00Z",
          .unused = {},
          .plant = plant,
          .zero_counts = {1.5F},
          .gain_error = {0.25F},
          .misfit = 1.25,
          .drift = {{0.125, 0.5}, {-0.0625, 0.25}}};
}

std::string Problem(const std::string& text) {
  try {
    ParseHistory(text, "health.json", kTwoChannels);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(HealthHistory, IsReadAsItWasWritten) {
  HealthHistory history;
  history.Add(RunOf("1"));
  history.Add(RunOf("2", 18446744073709551615U));
  history.run[1].unused = "why";
  EXPECT_EQ(ParseHistory(HistoryText(kTwoChannels, history), "", kTwoChannels).run, history.run);
  EXPECT_TRUE(ParseHistory(HistoryText(kTwoChannels, {}), "", kTwoChannels).run.empty());
}

TEST(HealthHistory, ABrokenFileIsNamed) {
  HealthHistory history;
  history.Add(RunOf("1"));
  const std::string text = HistoryText(kTwoChannels, history);
  EXPECT_NE(Problem(text.substr(0, text.size() / 2)), "");
  EXPECT_NE(Problem("{}"), "");
  EXPECT_NE(Problem("[1]"), "");
  history.run[0].drift.pop_back();
  EXPECT_EQ(Problem(HistoryText(kTwoChannels, history)),
            "health.json: runs[0]: 'value': expected 2 numbers");
}

TEST(HealthHistory, AFileOfOtherChannelsIsRefused) {
  const std::vector<DriftChannel> other = {kTwoChannels[0]};
  EXPECT_EQ(Problem(HistoryText(other, {})),
            "health.json: is of a rig with other gauges or joints than this config's");
}

TEST(HealthHistory, IsBoundedAndKeepsItsReference) {
  HealthHistory history;
  for (int i = 0; i < 400; ++i) history.Add(RunOf(std::to_string(i)));
  ASSERT_EQ(history.run.size(), HealthHistory::kMost);
  EXPECT_EQ(history.run.front().run, "0");
  EXPECT_EQ(history.run[kReferenceRuns - 1].run, "9");
  EXPECT_EQ(history.run.back().run, "399");
  // Of a new plant, the runs of the old one go first.
  for (int i = 0; i < 5; ++i) history.Add(RunOf("new " + std::to_string(i), 8));
  EXPECT_EQ(history.run.front().run, "5");
}

}  // namespace
}  // namespace flexarm
