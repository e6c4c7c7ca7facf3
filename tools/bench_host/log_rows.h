#pragma once

#include "tools/bench_host/bench_row.h"
#include "tools/bench_host/bench_setting.h"

namespace flexarm {

/// Replay of the recorded run: reading, every step again, comparison of bytes.
/// A run that does not replay exactly is a failed check.
BenchRow ReplayRow(const BenchSetting& setting, const RecordedRun& run);

/// The samples of the recorded run as CSV, without writing the file.
BenchRow ExportRow(const RecordedRun& run, const BenchSetting& setting);

}  // namespace flexarm
