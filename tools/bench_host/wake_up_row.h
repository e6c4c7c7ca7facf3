#pragma once

#include <filesystem>
#include <string>

#include "tools/bench_host/bench_row.h"
#include "tools/bench_host/bench_setting.h"

namespace flexarm {

/// Wake-up of the daemon's control thread on the simulated arm in real time, and after it of
/// cyclictest with the same priority and period. Not measured where real time is not permitted, or
/// with a config of real hardware, which this never touches.
BenchRow WakeUpRow(const BenchSetting& setting, const std::filesystem::path& scratch);

/// What cyclictest says of its thread.
struct CyclictestResult {
  double mean_us, worst_us;
};
/// @param output  of cyclictest --quiet with one thread
/// @throws std::runtime_error if it has no such line
CyclictestResult ParseCyclictest(const std::string& output);

}  // namespace flexarm
