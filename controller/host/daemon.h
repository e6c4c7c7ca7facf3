#pragma once

#include <functional>
#include <optional>
#include <string>

#include "controller/host/run_judge.h"
#include "controller/runlog/trip_reports.h"
#include "controller/types/experiment.h"
#include "controller/types/records.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// Options of the daemon.
struct DaemonOptions {
  RigConfig config;
  std::string config_file;               ///< as it was given, for the status
  std::optional<Experiment> experiment;  ///< run once, unattended; then the daemon ends
  std::optional<double> run_for_s;       ///< end after this long
  bool realtime = true;                  ///< false: --without-realtime; a simulated loop
                                         ///< runs in lock step then, behind the clock
  std::function<Experiment(const std::string& text, const std::string& name)> parse_experiment;
  RunJudge::WithLaw with_law = {};  ///< RunJudge's
  MakeTripPage trip_page = {};      ///< empty: no reports of trips are written
};

/// Result of the daemon.
struct DaemonResult {
  bool tripped = false;
  bool refused = false;  ///< the unattended run was refused
  std::int64_t log_errors = 0;
};

/// Runs the daemon until its experiment or its time ends, or SIGTERM, SIGINT or SIGHUP arrives.
/// Then it brings the arm to rest, disarms, closes the log and returns. Blocks those signals and
/// ignores SIGPIPE; SIGHUP has no effect if it was ignored before, as under nohup(1).
/// @throws RejectedError, RealtimeRejectedError, HalError, std::runtime_error before any motion
DaemonResult RunDaemon(const DaemonOptions& options);

}  // namespace flexarm
