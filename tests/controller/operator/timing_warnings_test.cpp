#include "controller/operator/timing_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/controller/operator/operator_records.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

struct TimingWarningsTest : testing::Test {
  EventQueue events{64};
  RecordedJournal journal;
  TimingWarnings warnings{&events, journal.Report()};
  TimingCounts counts{};
};

TEST_F(TimingWarningsTest, ThreadsInTimeAreNotMentioned) {
  warnings.Follow(0, counts);
  counts.oldest_permit_ns = 4 * kMs;
  warnings.Follow(20 * kMs, counts);
  EXPECT_TRUE(journal.lines.empty());
  EXPECT_TRUE(TakeEvents(&events).empty());
}

TEST_F(TimingWarningsTest, ALateThreadIsALineAndAnEventWithTheCounts) {
  counts = {.safety_overruns = 3,
            .oldest_permit_ns = 21 * kMs,
            .deadlines_missed = 2,
            .deadlines_often_missed = 1};
  warnings.Follow(20 * kMs, counts);
  const std::vector<RunEvent> logged = TakeEvents(&events);
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_EQ(logged[0].kind, "warning");
  EXPECT_EQ(logged[0].name, "late-threads");
  EXPECT_EQ(logged[0].time_ns, 20 * kMs);
  EXPECT_EQ(nlohmann::json::parse(logged[0].value_json),
            nlohmann::json({{"trips", false},
                            {"safety_overruns", 3},
                            {"safety_worst_ms", 21.0},
                            {"deadlines_missed_in_a_row", 2},
                            {"deadlines_often_missed", 1}}));
  ASSERT_EQ(journal.lines.size(), 1u);
  EXPECT_EQ(journal.lines[0], RecordedJournal::Line(true, logged[0].text));
  EXPECT_THAT(logged[0].text, testing::HasSubstr(logged[0].value_json)) << "the figures";
}

TEST_F(TimingWarningsTest, EachCountWarnsButOnceInTenSecondsAtMost) {
  for (std::uint32_t* count :
       {&counts.safety_overruns, &counts.deadlines_missed, &counts.deadlines_often_missed}) {
    journal.lines.clear();
    TimingWarnings fresh(&events, journal.Report());
    fresh.Follow(0, {});
    ++*count;
    for (std::int64_t k = 1; k <= 1'000; ++k) {  // 20 s
      if (k % 50 == 0) ++*count;
      fresh.Follow(k * 20 * kMs, counts);
    }
    EXPECT_EQ(journal.lines.size(), 2u);
    *count = 0;
    TakeEvents(&events);
  }
}

}  // namespace
}  // namespace flexarm
