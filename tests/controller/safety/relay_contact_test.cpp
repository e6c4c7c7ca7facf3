#include "controller/safety/relay_contact.h"

#include <gtest/gtest.h>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using enum RelayContact;

TEST(RelayContact, WithoutAContactNothingIsJudged) {
  RelayContactMonitor monitor;
  for (int tick = 0; tick < 1000; ++tick) {
    EXPECT_FALSE(monitor.Judge(tick * kMs, tick > 500, kNone));
  }
}

// From each command and contact to each other, for each delay of the contact.
TEST(RelayContact, MustFollowItsCommandWithinATenthOfASecond) {
  for (const bool closes : {false, true}) {
    for (int delay = 0; delay < 200; ++delay) {
      RelayContactMonitor monitor;
      for (int tick = -10; tick < 300; ++tick) {
        const bool told = tick >= 0 ? closes : !closes;
        const bool is = tick >= delay ? closes : !closes;
        const bool fails = monitor.Judge(tick * kMs, told, is ? kClosed : kOpen);
        // The last tick in which both agreed is -1.
        ASSERT_EQ(fails, tick - -1 > 100 && tick < delay) << closes << delay << tick;
      }
    }
  }
}

TEST(RelayContact, AContradictionFromTheFirstTickOnCountsFromThere) {
  RelayContactMonitor monitor;
  EXPECT_EQ(monitor.evidence().value, 0.0);
  EXPECT_TRUE(monitor.agrees()) << "nothing is known before the first tick";
  EXPECT_EQ(monitor.evidence().channel, static_cast<std::uint32_t>(LineTrouble::kRelayStuckClosed))
      << "told to be open";
  for (int tick = 1000; tick <= 1100; ++tick) {
    EXPECT_FALSE(monitor.Judge(tick * kMs, false, kClosed));
  }
  EXPECT_TRUE(monitor.Judge(1101 * kMs, false, kClosed));
  EXPECT_DOUBLE_EQ(monitor.evidence().value, 0.101);
  EXPECT_DOUBLE_EQ(monitor.evidence().limit, 0.1);
  EXPECT_EQ(monitor.evidence().channel, static_cast<std::uint32_t>(LineTrouble::kRelayStuckClosed));
  EXPECT_EQ(monitor.evidence().detail, 0u);
  EXPECT_TRUE(monitor.Judge(5000 * kMs, false, kClosed)) << "as long as it contradicts";
  EXPECT_FALSE(monitor.Judge(5001 * kMs, false, kOpen));
}

TEST(RelayContact, TheEvidenceSaysWhichWayItIsStuck) {
  RelayContactMonitor monitor;
  monitor.Judge(0, true, kClosed);
  EXPECT_TRUE(monitor.Judge(200 * kMs, true, kOpen));
  EXPECT_EQ(monitor.evidence().channel, static_cast<std::uint32_t>(LineTrouble::kRelayStuckOpen));
}

}  // namespace
}  // namespace flexarm
