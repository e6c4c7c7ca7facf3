#pragma once

#include <string>
#include <vector>

#include "tools/benchmark/benchmark.h"

namespace flexarm {

/// Compares the results of the design study with those of the benchmark: one row per scenario and
/// law that both have. A row that does not reach the design study names the cause. Source:
/// docs/theory/payload.md 6.2 and 6.3.
TextTable StudyComparison(const BenchmarkTable& moves);

}  // namespace flexarm
