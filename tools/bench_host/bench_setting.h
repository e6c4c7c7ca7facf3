#pragma once

#include <filesystem>
#include <vector>

#include "config/config.h"
#include "controller/types/step_types.h"
#include "tools/bench_host/timing.h"

namespace flexarm {

/// What the rows are measured with.
struct BenchSetting {
  std::filesystem::path config_file;
  RigConfig config;
  Experiment experiment;
  std::filesystem::path programs;  ///< folder of flexarmd and flexarm-cvode-race
  bool quick;                      ///< few repetitions, nothing that takes seconds

  /// Of work that takes less than a millisecond.
  Repetitions short_work() const {
    return {.count = quick ? 5U : 31U, .each_s = quick ? 1e-3 : 5e-3};
  }
  /// Of work that takes up to a second.
  std::size_t long_count() const { return quick ? 2 : 9; }
  std::int64_t most_counted() const { return quick ? 300'000 : 20'000'000; }
};

/// A run of the setting's experiment in lock step, and where its log is.
struct RecordedRun {
  std::filesystem::path log;
  std::vector<StepInput> inputs;  ///< of the control step, in order
};

/// @param folder  for the log
RecordedRun RecordRun(const BenchSetting& setting, const std::filesystem::path& folder);

}  // namespace flexarm
