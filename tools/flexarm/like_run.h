#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "config/config.h"
#include "estimator/calibration.h"

namespace flexarm {

/// What `simulate --like RUN` takes from a run: the rig's config with its seed, the experiment,
/// the payload, the place of the arm at the start, and the calibration.
struct LikeRun {
  RigConfig config;
  Experiment experiment;
  std::optional<double> payload_kg;  ///< empty: the log of a rig, whose payload is not known
  std::string payload_estimate{};    ///< of the run, for a message: "0.31 +- 0.02 kg"; "": none
  std::array<double, 2> start_rad{};
  /// Of the gauges. Zero for the log of a rig: it corrects gauges that the simulated arm has not.
  Calibration calibration{};
};

/// @throws InputError if the log has no experiment or no samples
LikeRun LoadLikeRun(const std::filesystem::path& file);

}  // namespace flexarm
