#pragma once

#include <string>
#include <vector>

#include "tools/benchmark/benchmark.h"

namespace flexarm {

/// What the design study measured, beside what the benchmark measures
/// here: a row a scenario and law that both have. What is out of the design study's reach has its
/// cause.
/// Source: docs/theory/payload.md 6.2 and 6.3.
TextTable StudyComparison(const BenchmarkTable& moves);

}  // namespace flexarm
