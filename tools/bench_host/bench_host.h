#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tools/bench_host/bench_row.h"
#include "tools/bench_host/bench_setting.h"
#include "tools/bench_host/float_bound.h"
#include "tools/bench_host/machine_notes.h"

namespace flexarm {

/// The table of one machine.
struct BenchReport {
  bool quick;
  std::string config;  ///< its file, as given
  MachineNotes machine;
  std::vector<FloatBound> bounds;
  std::vector<BenchRow> rows;
};

/// How many rows RunBenchHost makes.
std::size_t BenchRowsOf(const BenchSetting& setting);

/// Measures everything, minutes of work; with `quick` some seconds.
/// @param progress  called with the number of rows that are done
BenchReport RunBenchHost(const BenchSetting& setting,
                         const std::function<void(std::size_t)>& progress = {});

/// True if something that was to be compared differs: a replay, a right-hand side.
bool AnyCheckFailed(const BenchReport& report);

}  // namespace flexarm
