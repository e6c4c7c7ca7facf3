#include "tools/bench_host/flop_counter.h"

#include <gtest/gtest.h>

#include <csignal>
#include <vector>

namespace flexarm {
namespace {

// Two tests are skipped where nothing can be counted, as the table says then: on another processor,
// or where ptrace is forbidden.
volatile int written = 0;  // so that a loop is not left out

// The number stands in the source: a product and a sum an element, whatever the compiler makes of
// them. Sums in order: without -ffast-math no compiler changes that.
TEST(FlopCounter, CountsADotProductExactly) {
  constexpr std::int64_t kElements = 200;
  const std::vector<double> a(kElements, 1.5), b(kElements, 2.5);
  volatile double result = 0.0;
  const CountResult counted = CountWork(
      [&] {
        double sum = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
        result = sum;
      },
      1'000'000);
  if (!counted.counted()) GTEST_SKIP() << counted.problem;
  EXPECT_EQ(counted.count.flops, 2 * kElements);
  EXPECT_GT(counted.count.instructions, counted.count.flops / 2);
}

// What a first call alone does is not counted, and nothing of it is seen in this process.
TEST(FlopCounter, CountsTheSecondCallInAnotherProcess) {
  int calls = 0;
  volatile double x = 1.5, y = 0.0;
  const CountResult counted = CountWork(
      [&] {
        if (calls++ == 0) {
          for (int i = 0; i < 100; ++i) y = y + x;
        }
        y = y * x;
      },
      1'000'000);
  if (!counted.counted()) GTEST_SKIP() << counted.problem;
  EXPECT_EQ(counted.count.flops, 1);
  EXPECT_EQ(calls, 0);
}

TEST(FlopCounter, GivesUpAndSaysSo) {
  const CountResult counted = CountWork(
      [] {
        for (int i = 0; i < 10'000; ++i) written = i;
      },
      1000);
  EXPECT_FALSE(counted.counted());
}

TEST(FlopCounter, TellsOfWorkThatEndsItsProcess) {
  const CountResult counted = CountWork([] { std::raise(SIGUSR1); }, 1000);
  EXPECT_FALSE(counted.counted());
  EXPECT_FALSE(counted.problem.empty());
}

}  // namespace
}  // namespace flexarm
