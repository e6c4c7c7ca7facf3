#pragma once

#include <string>
#include <vector>

#include "tools/bench_host/timing.h"

namespace flexarm {

/// How many floating-point operations a second one core can make with registers of one width.
struct FloatBound {
  std::string name;  ///< key: "sse2"
  std::string what;  ///< for people
  double flops_per_s;
};

/// Measures sums and products of doubles that do not wait for each other, for each width that this
/// processor has, the narrowest first, which any build uses. The best repetition counts.
std::vector<FloatBound> MeasureFloatBounds(const Repetitions& repetitions);

/// The largest of them, 1/s.
double BestOf(const std::vector<FloatBound>& bounds);

}  // namespace flexarm
