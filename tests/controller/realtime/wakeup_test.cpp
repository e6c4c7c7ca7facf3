#include "controller/realtime/wakeup.h"

#include <gtest/gtest.h>

#include <thread>

#include "controller/realtime/clock.h"
#include "tests/support/loop_time.h"

// Test machines guarantee no latency: these tests assert what ended the sleep, not when.

namespace flexarm {
namespace {

constexpr std::int64_t kMinuteNs = 60'000 * kMs;

TEST(Wakeup, WithoutAWakeTheSleepEndsInTime) {
  Wakeup wakeup;
  const std::int64_t until_ns = MonotonicNow() + 2 * kMs;
  EXPECT_FALSE(wakeup.SleepUntil(until_ns));
  EXPECT_GE(MonotonicNow(), until_ns);
  EXPECT_FALSE(wakeup.SleepUntil(0)) << "an instant that has passed";
}

TEST(Wakeup, AWakeThatHasComeEndsTheNextSleepAtOnceAndOnce) {
  Wakeup wakeup;
  wakeup.Wake();
  wakeup.Wake();
  EXPECT_TRUE(wakeup.SleepUntil(MonotonicNow() + kMinuteNs));
  EXPECT_FALSE(wakeup.SleepUntil(MonotonicNow() + 2 * kMs)) << "two wakes were one";
}

TEST(Wakeup, AWakeIsTakenOnce) {
  Wakeup wakeup;
  EXPECT_FALSE(wakeup.Take());
  wakeup.Wake();
  EXPECT_TRUE(wakeup.Take());
  EXPECT_FALSE(wakeup.Take());
}

// A wake that got lost would let the sleeper wait for a minute each time.
TEST(Wakeup, NoWakeOfAnotherThreadIsLost) {
  constexpr int kWakes = 2'000;
  Wakeup wakeup, back;
  std::thread sleeper([&] {
    for (int i = 0; i < kWakes; ++i) {
      EXPECT_TRUE(wakeup.SleepUntil(MonotonicNow() + kMinuteNs));
      back.Wake();
    }
  });
  for (int i = 0; i < kWakes; ++i) {
    wakeup.Wake();
    EXPECT_TRUE(back.SleepUntil(MonotonicNow() + kMinuteNs));
  }
  sleeper.join();
}

}  // namespace
}  // namespace flexarm
