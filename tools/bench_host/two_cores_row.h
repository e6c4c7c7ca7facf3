#pragma once

#include <filesystem>

#include "tools/bench_host/bench_row.h"
#include "tools/bench_host/bench_setting.h"

namespace flexarm {

/// A sweep over seeds with one run at a time, and with two: how much faster the second core makes
/// it. Wall time.
BenchRow TwoCoresRow(const BenchSetting& setting, const std::filesystem::path& scratch);

}  // namespace flexarm
