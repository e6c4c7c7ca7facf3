#pragma once

#include <filesystem>

#include "tools/benchmark/benchmark.h"

namespace flexarm {

/// Residual and motion of every scenario, a bar a law: the mean over the runs, with the largest as
/// a whisker.
/// @throws std::runtime_error if gnuplot fails
void DrawLimits(const BenchmarkTable& table, const std::filesystem::path& output);

}  // namespace flexarm
