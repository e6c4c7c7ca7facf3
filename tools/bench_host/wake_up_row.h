#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/bench_host/bench_row.h"
#include "tools/bench_host/bench_setting.h"

namespace flexarm {

/// Wake-ups of the daemon's control thread on the simulated arm in real time, and after it as many
/// of cyclictest with the same priority and period. Not measured where real time is not permitted,
/// or with a config of real hardware, which this never touches.
BenchRow WakeUpRow(const BenchSetting& setting, const std::filesystem::path& scratch);

/// The same while stress-ng keeps every processor, the disk and the memory busy.
BenchRow LoadedWakeUpRow(const BenchSetting& setting, const std::filesystem::path& scratch);

/// How late each wake-up was that cyclictest counted, us, in whole us, in ascending order. Those
/// beyond the end of its histogram count as its end, and the latest as cyclictest says.
/// @param output  of cyclictest --quiet --histogram with one thread
/// @throws std::runtime_error if it is not that
std::vector<double> ParseCyclictest(const std::string& output);

}  // namespace flexarm
