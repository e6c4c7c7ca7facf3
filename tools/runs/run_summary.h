#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "config/config.h"
#include "controller/runlog/metrics.h"
#include "controller/runlog/run_reader.h"

namespace flexarm {

/// A run log with the config and the experiment that it holds.
struct LoadedRun {
  std::filesystem::path file;
  RunState state = RunState::kClosed;
  std::uint64_t left_out_bytes = 0;  ///< of a record file, behind its last whole record
  std::string digest;                ///< of a closed run
  bool digest_holds = false;         ///< false: the log was damaged since it was written
  RunContents contents;
  RigConfig config;
  std::optional<Experiment> experiment;  ///< empty: the log has none

  bool closed() const { return state == RunState::kClosed; }
  double period_s() const { return config.loop.period_s(); }
  /// An instant of the loop's clock in the time of the log.
  double TimeOf(std::int64_t time_ns) const {
    return static_cast<double>(time_ns - contents.info.start_ns) * 1e-9;
  }
};

/// @throws InputError, ConfigError
LoadedRun LoadRun(const std::filesystem::path& file);

/// @throws InputError if the config text inside the log cannot be read
RigConfig ConfigOf(const RunReader& reader);

/// Metrics of a run; empty if it had no experiment.
std::optional<RunMetrics> MetricsOf(const LoadedRun& run);

/// The metrics with the JSON keys of the contract. Unknown values are null.
nlohmann::ordered_json ToJson(const RunMetrics& metrics);

/// When the tip settled: "0.46 s", or why it did not: "not settled: 16 mm off its target", "not
/// settled: still moving at the end of a rest", "no rest to judge".
std::string SettlingText(const RunMetrics& metrics);

/// The record of the first trip of a run, with its cause; empty if the run did not trip.
std::optional<SafetyRecord> TripOf(const std::vector<SafetyRecord>& records);

/// A JSON text, or null if it is empty.
nlohmann::ordered_json TextOrNull(const std::string& text);

/// A JSON number, or null if it is not finite.
nlohmann::ordered_json NumberOrNull(double value);

}  // namespace flexarm
