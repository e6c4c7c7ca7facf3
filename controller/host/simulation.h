#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "controller/runlog/metrics.h"
#include "controller/runlog/run_sink.h"
#include "controller/types/experiment.h"
#include "controller/types/messages.h"
#include "controller/types/rig_config.h"
#include "controller/types/trip_cause.h"

namespace flexarm {

/// One run of the whole stack in lock step: an unattended arm, run, stop and disarm.
struct SimulationRequest {
  RigConfig config;
  Experiment experiment;
  std::filesystem::path experiment_file = {};  ///< for messages; may be empty
  /// Config of the simulated rig if it differs from that of the design; may differ from `config` in
  /// the settings of the plant only. It is not logged.
  std::optional<RigConfig> plant = std::nullopt;
  std::optional<double> payload_kg;          ///< of the plant; empty: that of its config
  std::optional<std::filesystem::path> log;  ///< must not exist; empty: no log
  RunLabel label = {};                       ///< for the log
  std::array<double, 2> start_rad = {};      ///< hub angles at which the arm rests before the run
  /// Of the gauges, for the loop; the counters' zeros follow from `start_rad`.
  Calibration calibration = {};
};

/// The trip of a simulated run.
struct SimulatedTrip {
  TripCause cause;
  Evidence evidence;
  double at_s;  ///< after the start of the experiment
};

/// The calibration of the loop in a simulated run: that of the request, with the zeros of the
/// counters, which read 0 where the arm stands at the start.
Calibration CalibrationOf(const SimulationRequest& request);

struct SimulationResult {
  bool completed = false;  ///< every tick of the experiment ran, and no trip
  TripCause trip = TripCause::kNone;
  std::optional<SimulatedTrip> trip_found;  ///< not of a simulation with a known state
  std::int64_t ticks = 0;                   ///< in state Running
  RunMetrics metrics;
  std::vector<double> move_duration_s;  ///< of the rows [[move]], as given or as chosen
  int delay_found = 0;                  ///< samples beyond the known delay, last result of the run
  double realtime_factor = 0.0;  ///< simulated time over wall time of the loop, recorder included
};

/// @param progress  called repeatedly with the simulated time, s; may be empty
/// @throws RejectedError when the design, the experiment (with its file) or the log is refused;
///   std::runtime_error when the safety machine refused the run
SimulationResult Simulate(const SimulationRequest& request,
                          const std::function<void(double)>& progress = {});

}  // namespace flexarm
