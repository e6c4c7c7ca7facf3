#pragma once

#include <string>
#include <vector>

#include "tools/benchmark/benchmark.h"

namespace flexarm {

/// What the study of the laws that find the payload measured, beside what the benchmark measures
/// here: a row a scenario and law that both have. What is out of the study's reach has its cause.
/// Source: beyond.md section 4.
TextTable StudyComparison(const BenchmarkTable& moves);

}  // namespace flexarm
