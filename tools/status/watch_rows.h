#pragma once

#include <string>

#include "tools/status/reply.h"
#include "tools/status/styled_row.h"

// The parts of the screen of `flexarm status --watch`, each of the answer to the command "status".
// A key that is missing, or of another type, leaves its place empty. Pure functions.

namespace flexarm {

/// What is shown: the last status, and how old it is.
struct WatchedStatus {
  Reply status;           ///< the last answer that was good; null: there was none yet
  double age_s = 0.0;     ///< since it came
  std::string no_answer;  ///< why there is none now; empty: `status` is that of now
};

/// From this age on a reading is marked: as long as the daemon's watchdog bears. The newest one is
/// up to two periods of the loop old.
inline constexpr double kStale_ms = 100.0;

/// "42 us", "2.3 ms", "35 ms", "3.2 s", "12 min".
std::string AgeText(double age_s);

/// Rig, version, time; before that, why there is no answer, and how old the last one is.
Rows HeaderRows(const WatchedStatus& watched, int columns);
/// State of the safety machine, the run with its progress, what makes the torque.
Rows StateRows(const Reply& status, int columns);
/// The latched trip, and every cause that is present.
Rows TripRows(const Reply& status, int columns);
/// Relay, emergency stop, reset button, limit switches.
Rows LampRows(const Reply& status, int columns);
/// Of each joint angle, reference, rate and torque; with bars from 80 columns on, with limits from
/// 104.
Rows JointRows(const Reply& status, int columns);
/// Counts and angle of each counter.
Rows EncoderRows(const Reply& status, int columns);
/// The estimate with its standard deviation and warnings; empty: there is none.
Rows PayloadRows(const Reply& status);
/// Receiver and counts of the datagrams; empty: telemetry is off.
Rows TelemetryRows(const Reply& status);
/// A row for each channel that drifts; empty: none does.
Rows HealthRows(const Reply& status);
/// Health of each bus.
Rows BusRows(const Reply& status, int columns);
/// Of each thread its greatest lateness, and how often it was late.
Rows ThreadRows(const Reply& status, int columns);

}  // namespace flexarm
