#include "controller/safety/line_calls.h"

#include <gtest/gtest.h>

#include <bit>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr std::int64_t kBudgetNs = SafetyLines::kBudgetNs;
constexpr std::int64_t kStallNs = 5 * kMs;

LineCalls ReadTook(std::int64_t ns) { return {.read = {.took_ns = ns}}; }
LineCalls WriteTook(std::int64_t ns) { return {.write = {.took_ns = ns}}; }

TEST(LineCalls, CallsWithinTheBudgetAreFine) {
  LineCallMonitor monitor(kStallNs);
  for (int tick = 0; tick < 1000; ++tick) {
    EXPECT_FALSE(monitor.Judge({.read = {.took_ns = kBudgetNs}, .write = {.took_ns = kBudgetNs}}));
  }
}

TEST(LineCalls, AFailedCallCountsAtOnceAndAsLongAsItFails) {
  LineCallMonitor monitor(kStallNs);
  EXPECT_TRUE(monitor.Judge({.read = {.ok = false}}));
  EXPECT_TRUE(monitor.Judge({.write = {.ok = false}}));
  EXPECT_FALSE(monitor.Judge({}));
}

TEST(LineCalls, ACallThatTakesLongerThanTheTimeOutOfThePermitCountsAtOnce) {
  LineCallMonitor monitor(kStallNs);
  EXPECT_FALSE(monitor.Judge(ReadTook(kStallNs)));
  EXPECT_FALSE(monitor.Judge(WriteTook(kStallNs)));
  EXPECT_TRUE(monitor.Judge(ReadTook(kStallNs + 1)));
  LineCallMonitor other(kStallNs);
  EXPECT_TRUE(other.Judge(WriteTook(kStallNs + 1)));
  EXPECT_TRUE(other.Judge(WriteTook(50 * kMs)));
}

TEST(LineCalls, AChipWhoseEveryCallSleepsShowsItInFourTicks) {
  for (const LineCalls& slow : {ReadTook(kBudgetNs + 1), WriteTook(kBudgetNs + 1)}) {
    LineCallMonitor monitor(kStallNs);
    for (int tick = 0; tick < 3; ++tick) EXPECT_FALSE(monitor.Judge(slow));
    EXPECT_TRUE(monitor.Judge(slow));
  }
}

// A late interrupt now and then: three slow ticks of any 32 are no fault.
TEST(LineCalls, ThreeSlowTicksOfThirtyTwoAreNoFault) {
  LineCallMonitor monitor(kStallNs);
  for (int tick = 0; tick < 10'000; ++tick) {
    const bool slow = tick % 32 < 3;
    EXPECT_FALSE(monitor.Judge(slow ? ReadTook(4 * kMs) : LineCalls{})) << tick;
  }
}

TEST(LineCalls, AChipThatSleepsInEveryEighthCallShowsItInTwentyFiveTicks) {
  LineCallMonitor monitor(kStallNs);
  for (int tick = 0; tick < 24; ++tick) {
    EXPECT_FALSE(monitor.Judge(tick % 8 == 0 ? ReadTook(kBudgetNs + 1) : LineCalls{}));
  }
  EXPECT_TRUE(monitor.Judge(ReadTook(kBudgetNs + 1)));
}

// Every pattern of 20 ticks, against the count of slow ones so far.
TEST(LineCalls, TheFourthSlowTickCountsWhateverIsBetween) {
  for (unsigned pattern = 0; pattern < 1U << 20U; pattern += 7) {
    LineCallMonitor monitor(kStallNs);
    for (int tick = 0; tick < 20; ++tick) {
      const bool slow = (pattern >> tick & 1U) != 0;
      const int slow_so_far = std::popcount(pattern & ((2U << tick) - 1));
      ASSERT_EQ(monitor.Judge(slow ? WriteTook(kMs) : LineCalls{}), slow_so_far >= 4)
          << pattern << ", tick " << tick;
    }
  }
}

TEST(LineCalls, GoodTicksEndItWhenFewerThanFourOfTheLastWereSlow) {
  LineCallMonitor monitor(kStallNs);
  for (int tick = 0; tick < 4; ++tick) monitor.Judge(ReadTook(kMs));
  for (int tick = 0; tick < 28; ++tick) EXPECT_TRUE(monitor.Judge({})) << tick;
  EXPECT_FALSE(monitor.Judge({}));
}

void ExpectEvidence(const LineCalls& calls, double took_s, LineTrouble trouble) {
  const Evidence evidence = LineCallMonitor::EvidenceOf(calls);
  EXPECT_DOUBLE_EQ(evidence.value, took_s);
  EXPECT_DOUBLE_EQ(evidence.limit, 0.0002);
  EXPECT_EQ(evidence.channel, static_cast<std::uint32_t>(trouble));
  EXPECT_EQ(evidence.detail, 0U);
}

TEST(LineCalls, TheEvidenceIsTheCallThatFailedElseTheLongest) {
  ExpectEvidence({.read = {.ok = false, .took_ns = 3'000}}, 3e-6, LineTrouble::kReadFailed);
  ExpectEvidence({.write = {.ok = false, .took_ns = 4'000}}, 4e-6, LineTrouble::kWriteFailed);
  ExpectEvidence({.read = {.took_ns = 50 * kMs}, .write = {.ok = false, .took_ns = 4'000}}, 4e-6,
                 LineTrouble::kWriteFailed);
  ExpectEvidence({.read = {.ok = false, .took_ns = 1'000}, .write = {.took_ns = kMs}}, 1e-6,
                 LineTrouble::kReadFailed);
  ExpectEvidence({.read = {.took_ns = 50 * kMs}, .write = {.took_ns = kMs}}, 0.05,
                 LineTrouble::kReadSlow);
  ExpectEvidence({.read = {.took_ns = kMs}, .write = {.took_ns = 50 * kMs}}, 0.05,
                 LineTrouble::kWriteSlow);
  ExpectEvidence({.read = {.took_ns = kMs}, .write = {.took_ns = kMs}}, 0.001,
                 LineTrouble::kReadSlow);
}

}  // namespace
}  // namespace flexarm
