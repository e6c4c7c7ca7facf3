#include "controller/operator/loop_watch.h"

#include <gtest/gtest.h>

#include "tests/controller/operator/operator_records.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr std::int64_t kOldMs = LoopWatch::kOldestNs / kMs;

struct Watched {
  // `safety_ms`, `control_ms`: age of the newest permit and step.
  bool Follow(std::int64_t safety_ms, std::int64_t control_ms) {
    OperatorSnapshot now{};
    now.now_ns = 1'000'000 * kMs;
    now.permit.renewed_ns = now.now_ns - safety_ms * kMs;
    now.tick.input.now_ns = now.now_ns - control_ms * kMs;
    return watch.Follow(now, journal.Report());
  }

  LoopWatch watch;
  RecordedJournal journal;
};

TEST(LoopWatch, IsAliveWhileBothThreadsAre) {
  Watched loop;
  EXPECT_TRUE(loop.Follow(0, 0));
  EXPECT_TRUE(loop.Follow(kOldMs - 1, kOldMs - 1));
  EXPECT_FALSE(loop.Follow(kOldMs, 0));
  EXPECT_FALSE(loop.Follow(0, kOldMs));
}

TEST(LoopWatch, BeforeTheFirstPermitThereIsNothingToReport) {
  Watched loop;
  OperatorSnapshot now{};
  now.permit.renewed_ns = INT64_MIN;
  EXPECT_FALSE(loop.watch.Follow(now, loop.journal.Report()));
  EXPECT_TRUE(loop.Follow(0, 0));
  EXPECT_TRUE(loop.journal.lines.empty());
}

TEST(LoopWatch, TheJournalNamesTheThreadThatStoodStillOnce) {
  Watched loop;
  loop.Follow(0, 0);
  for (int i = 0; i < 3; ++i) loop.Follow(0, kOldMs + i);
  ASSERT_EQ(loop.journal.lines.size(), 1U);
  EXPECT_TRUE(loop.journal.lines[0].first) << "an error";
  EXPECT_EQ(loop.journal.Find("not notified: the control thread has"), 0);
  loop.Follow(0, 0);
  EXPECT_EQ(loop.journal.Find("notified again"), 1);
  loop.Follow(kOldMs, 0);
  EXPECT_EQ(loop.journal.Find("not notified: the safety thread has"), 2);
  loop.Follow(0, 0);
  loop.Follow(kOldMs, kOldMs);
  EXPECT_EQ(loop.journal.Find("the safety and control threads have"), 4);
}

}  // namespace
}  // namespace flexarm
