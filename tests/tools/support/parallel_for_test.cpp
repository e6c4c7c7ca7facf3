#include "tools/support/parallel_for.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace flexarm {
namespace {

TEST(ParallelFor, RunsEachOnceAndReportsTheEnd) {
  std::vector<std::atomic<int>> runs(1000);
  std::size_t reported = 0;
  ParallelFor(
      runs.size(), [&](std::size_t i) { ++runs[i]; },
      [&](std::size_t done) {
        EXPECT_GE(done, reported);
        reported = done;
      });
  for (const auto& count : runs) EXPECT_EQ(count, 1);
  EXPECT_EQ(reported, 1000u);
}

TEST(ParallelFor, AcceptsACountOfZero) {
  ParallelFor(0, [](std::size_t) { FAIL(); });
}

TEST(ParallelFor, TheFirstExceptionEndsTheWorkAndIsRethrown) {
  std::atomic<int> runs = 0;
  const auto body = [&](std::size_t i) {
    ++runs;
    if (i == 3) throw std::runtime_error("three");
  };
  // One worker only: with several, another worker may run all the rest before the exception is
  // caught.
  EXPECT_THROW(ParallelFor(100000, body, {}, 1), std::runtime_error);
  EXPECT_EQ(runs, 4);
  EXPECT_THROW(ParallelFor(100000, body), std::runtime_error);
}

}  // namespace
}  // namespace flexarm
