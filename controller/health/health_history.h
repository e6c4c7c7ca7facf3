#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "controller/files/external_file.h"
#include "controller/health/drift_channel.h"
#include "controller/health/drift_regression.h"
#include "controller/health/run_health.h"
#include "controller/types/control_config.h"
#include "estimator/calibration.h"

namespace flexarm {

/// The figures of one run, as they are kept.
struct HealthRecord {
  std::string run;                             ///< how the run is called: its number, or its log
  std::string start_utc;                       ///< ISO 8601
  std::string unused;                          ///< why its figures are not judged; empty: they are
  std::uint64_t plant = 0;                     ///< PlantMark of its config
  std::vector<float> zero_counts, gain_error;  ///< of the gauges' calibration
  double misfit = 0.0;                         ///< RunFigures::misfit
  std::vector<DriftFigure> drift;              ///< of DriftChannels, in their order

  friend bool operator==(const HealthRecord&, const HealthRecord&) = default;
};

/// The runs of a rig, oldest first.
struct HealthHistory {
  /// Of runs that are kept. Of more, the reference stays and the oldest of the others goes.
  static constexpr std::size_t kMost = 300;

  std::vector<HealthRecord> run;

  void Add(HealthRecord record);
};

/// A number that differs between configs whose arm, sensors or period differ: figures of different
/// plants are not compared.
std::uint64_t PlantMark(const ControlConfig& config);

/// @param calibration  that the run's loop had
HealthRecord RecordOf(const ControlConfig& config, const Calibration& calibration,
                      const RunFigures& figures);

/// In daemon.state_directory.
inline constexpr const char* kHealthFileName = "health.json";
inline constexpr FileKind kHealthFile{"the health of a rig", 4 * kMiB, FileSyntax::kJson};

/// The file of a history, one JSON object with a line for each run.
std::string HistoryText(const std::vector<DriftChannel>& channels, const HealthHistory& history);

/// @throws InputError with what is wrong; also if it is of other channels
HealthHistory ParseHistory(const std::string& text, const std::string& name,
                           const std::vector<DriftChannel>& channels);

}  // namespace flexarm
