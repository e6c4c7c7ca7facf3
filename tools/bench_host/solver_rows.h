#pragma once

#include <filesystem>

#include "tools/bench_host/bench_row.h"
#include "tools/bench_host/bench_setting.h"

namespace flexarm {

/// The plant against CVODE on SolverProblem, by the program flexarm-cvode-race: CVODE's fastest
/// settings whose error is not above the plant's.
BenchRow CvodeRow(const BenchSetting& setting, const std::filesystem::path& scratch);

/// The plant against ode45 of GNU Octave on SolverProblem, with arm_rate.m, whose rates are
/// compared with those of PlantRate first: the loosest tolerance whose error is not above the
/// plant's.
BenchRow OctaveRow(const BenchSetting& setting, const std::filesystem::path& scratch);

}  // namespace flexarm
