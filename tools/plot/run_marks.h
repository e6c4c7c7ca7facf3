#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/plot/plot_data.h"

namespace flexarm {

// The words on the pictures of a run.

/// Instant of sample 0 of the experiment, in the clock of the loop: the torque of the first Running
/// tick acts then. Without an experiment: the start of the log.
std::int64_t TimeZero_ns(const LoadedRun& run);

/// "waypoints, gain-scheduled on thesis-rig".
std::string TitleOf(const LoadedRun& run);
/// Date, payload, seed, nominal model.
std::string DetailsOf(const LoadedRun& run);
/// "flexarm replay FILE", for a shell.
std::string ReplayCommand(const LoadedRun& run);
/// The trip with value, limit and time; empty: none.
std::string TripText(const LoadedRun& run, std::int64_t zero_ns);

/// What happened, in order of time: the trip, commands, warnings and gaps of the log, and what the
/// experiment did to the simulated rig.
std::vector<PlotRun::Mark> MarksOf(const LoadedRun& run, std::int64_t zero_ns);

/// Lines of text with the metrics of a run. What a run was too short for is said in words.
std::vector<std::string> FigureLines(const RunMetrics& metrics);

}  // namespace flexarm
