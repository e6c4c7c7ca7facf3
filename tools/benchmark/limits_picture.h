#pragma once

#include <filesystem>

#include "tools/benchmark/benchmark.h"

namespace flexarm {

/// Draws residual and motion of every scenario with one bar per law: the mean over the runs, and
/// the largest as a whisker.
/// @throws std::runtime_error if gnuplot fails
void DrawLimits(const BenchmarkTable& table, const std::filesystem::path& output);

}  // namespace flexarm
