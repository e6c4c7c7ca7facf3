#include "tools/bench_host/wake_up_row.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace flexarm {
namespace {

// What cyclictest 2.5 prints with --quiet.
TEST(Cyclictest, MeanAndWorstAreRead) {
  const CyclictestResult result = ParseCyclictest(
      "# /dev/cpu_dma_latency set to 0us\n"
      "T: 0 ( 4711) P:80 I:20000 C:    300 Min:      3 Act:    5 Avg:    6 Max:      40\n");
  EXPECT_DOUBLE_EQ(result.mean_us, 6.0);
  EXPECT_DOUBLE_EQ(result.worst_us, 40.0);
  EXPECT_THROW(ParseCyclictest("T: 0 (4711) P:80"), std::runtime_error);
  EXPECT_THROW(ParseCyclictest("Avg: x Max: 3"), std::runtime_error);
}

}  // namespace
}  // namespace flexarm
