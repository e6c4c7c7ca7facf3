#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "config/config.h"
#include "controller/runlog/csv_import.h"
#include "controller/runlog/replay.h"
#include "tools/csv/strain_scale_check.h"

namespace flexarm {

/// Replay of a CSV file: what `flexarm replay FILE.csv` was given.
struct CsvReplayTask {
  std::filesystem::path source;
  RigConfig config;
  std::filesystem::path calibration;  ///< empty: none
  std::filesystem::path experiment;   ///< empty: none; the loop then has no reference
};

struct CsvReplayResult {
  ReplayResult result;
  /// Samples after the end of the experiment, left out. Nothing without an experiment: torques
  /// without a reference say nothing about those in the file.
  std::optional<std::int64_t> left_out;
  CsvFacts facts;
  StrainScaleResult scales;
};

/// Runs the samples of a CSV file through a new loop.
/// @throws InputError, ConfigError, RejectedError
CsvReplayResult ReplayCsv(const CsvReplayTask& task);

}  // namespace flexarm
