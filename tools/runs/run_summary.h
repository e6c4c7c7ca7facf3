#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "config/config.h"
#include "controller/runlog/metrics.h"
#include "controller/runlog/run_reader.h"

namespace flexarm {

/// A run with what its own log says that it was made with.
struct LoadedRun {
  std::filesystem::path file;
  bool closed = false;
  RunContents contents;
  RigConfig config;
  std::optional<Experiment> experiment;  ///< nothing: the log names none

  double period_s() const { return config.loop.period_s(); }
};

/// @throws InputError, ConfigError
LoadedRun LoadRun(const std::filesystem::path& file);

/// @throws InputError if the config text inside the log cannot be read
RigConfig ConfigOf(const RunReader& reader);

/// Of a run of an experiment; nothing if it had none.
std::optional<RunMetrics> MetricsOf(const LoadedRun& run);

/// The JSON keys of the contract. What is not known is null.
nlohmann::ordered_json ToJson(const RunMetrics& metrics);

/// The first trip of a run, and what caused it; nothing if it did not trip.
std::optional<SafetyRecord> TripOf(const std::vector<SafetyRecord>& records);

/// A JSON number, or null if it is not finite.
nlohmann::ordered_json NumberOrNull(double value);

}  // namespace flexarm
