#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// Instant at which a torque is output to the drives.
enum class OutputTiming : std::uint8_t {
  kNextTick,  ///< "next_tick": at the next sampling instant, with the exchange of the buses
  kAtOnce,    ///< "at_once": output_after_ms after the sampling instant that it was computed from
};

/// Section [loop]: timing of the control grid.
struct LoopConfig {
  double period_ms;          ///< Ts; sampling instants are at k Ts
  double acquire_before_ms;  ///< a control step is due this long after its sampling instant
  double step_deadline_ms;   ///< a step published later than this after its due instant misses its
                             ///< deadline
  OutputTiming output;
  double output_after_ms;     ///< of kAtOnce; not before the deadline of the step
  double actuation_delay_ms;  ///< known latency of drive and bus, from output to torque

  double period_s() const { return period_ms * 1e-3; }
  std::int64_t period_ns() const { return std::llround(period_ms * 1e6); }

  std::vector<Problem> Problems() const;
};

/// Section [log] but for its directory. All of it is optional in a file.
struct LogConfig {
  bool required = true;         ///< `arm` and `run` are refused without a file for the run's log
  double reserve_mb = 50.0;     ///< reserved on the disk for the next run: 25 minutes
  double keep_free_mb = 200.0;  ///< with less space than this beside it, there is no file
  double keep_days = 0.0;       ///< older runs are removed; 0: none
  double keep_total_mb = 0.0;   ///< the oldest runs are removed, until all are within it; 0: none
  bool keep_trips = true;       ///< neither removes the log of a trip
};

/// Sections [daemon] and [log].
struct DaemonConfig {
  std::string socket;           ///< path of the operator's Unix socket; $VAR is not expanded
  std::string state_directory;  ///< what must survive a restart: the latch file; one a daemon
  std::string log_directory;    ///< key log.directory: where run logs go
  LogConfig log;

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
