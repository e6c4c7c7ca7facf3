#pragma once

#include <array>
#include <cstdint>

#include "controller/exchange/history.h"
#include "controller/exchange/latest_value.h"
#include "controller/types/safety_state.h"
#include "controller/types/step_types.h"
#include "controller/types/trip_cause.h"
#include "hal/bus_fault.h"

// What the tasks tell each other. Every value is stamped with the instant from which it holds
// (History), so that who sees what depends on the time grid and not on the scheduler.

namespace flexarm {

/// The values that caused a trip.
struct Evidence {
  double value;           ///< what was measured
  double limit;           ///< what it broke
  std::uint32_t channel;  ///< joint, counter, strain row or bus, 1-based; 0: none
  std::uint32_t detail;   ///< of a bus: its BusFault, as bits; else 0
};

/// Control task -> drive. Holds from the instant at which it shall act.
struct TorqueCommand {
  std::array<double, 2> torque_nm;
  std::int64_t tick;
};

/// Safety task -> drive, control, operator: what is allowed, renewed every safety tick.
struct Permit {
  SafetyState state;
  TripCause cause;                ///< latched while Tripped
  std::int64_t renewed_ns;        ///< safety tick that wrote it
  std::int64_t running_since_ns;  ///< instant of the last change to Running; INT64_MIN: never
  Evidence evidence;              ///< of `cause`
  LineLevels levels;              ///< digital inputs, as that tick read them
};

/// Control task -> safety: its heartbeat, and what only the loop can see. Holds from the deadline
/// of the step on.
struct ControlReport {
  std::int64_t tick;    ///< -1: none yet
  std::int64_t due_ns;  ///< when that step was due
  TripCauses faults;
  Evidence evidence;  ///< of the lowest fault
  bool at_rest;
  bool experiment_done;
  int missed_in_a_row;
};

/// Drive side (plant task, or the buses) -> safety and control: its heartbeat, and what it did.
struct DriveReport {
  std::int64_t due_ns;  ///< of its last run
  bool bus_ok;
  bool drive_ok;
  BusFault fault{};                    ///< of the last exchange; none if it went well
  std::uint32_t failed = 0;            ///< exchanges that failed, and attempts to reconnect
  std::uint32_t recovered = 0;         ///< how often the bus was lost and came back
  LineLevels levels = kHealthyLevels;  ///< as the buses read them last; healthy where they do not
};

enum class RequestKind : std::uint8_t { kNone, kArm, kRun, kStop, kDisarm, kReset };

/// Operator -> safety. `not_before_ns` lets an unattended run plan its requests on the time grid.
struct OperatorRequest {
  RequestKind kind;
  std::uint32_t number;  ///< echoed in the answer
  std::int64_t not_before_ns;
  LineLevels may_open = 0;  ///< of a homing run: the limit switch that it looks for
};

enum class Refusal : std::uint8_t {
  kNone,          ///< accepted
  kWrongState,    ///< the state does not allow it
  kNotAtRest,     ///< the arm moves
  kCauseRemains,  ///< the trip's cause is still there
  kNoReset,       ///< the physical reset button has not been pressed since the trip
  kUnhealthy,     ///< a fact that would trip is present, or a task has not reported yet
  kCancelled,     ///< a planned arm or run, overtaken by a stop, a disarm or a trip
};

/// Safety -> operator: what became of a request.
struct RequestAnswer {
  std::uint32_t number;
  RequestKind kind;
  Refusal refusal;
  SafetyState state;   ///< when it was judged
  TripCauses present;  ///< causes present then
};

/// How the messages travel: one channel a reader, with as many entries as the slowest reader that
/// meets its deadline may be late.
using PermitHistory = History<Permit, 24>;
using ControlReportHistory = History<ControlReport, 4>;
using DriveReportHistory = History<DriveReport, 4>;
using PermitChannel = LatestValue<PermitHistory>;
using ControlReportChannel = LatestValue<ControlReportHistory>;
using DriveReportChannel = LatestValue<DriveReportHistory>;

/// What the channels hold before the first message.
inline constexpr Permit kNoPermit{.state = SafetyState::kStarting,
                                  .cause = TripCause::kNone,
                                  .renewed_ns = INT64_MIN,
                                  .running_since_ns = INT64_MIN,
                                  .evidence = {},
                                  .levels = kHealthyLevels};
inline constexpr ControlReport kNoControlReport{.tick = -1,
                                                .due_ns = INT64_MIN,
                                                .faults = 0,
                                                .evidence = {},
                                                .at_rest = false,
                                                .experiment_done = false,
                                                .missed_in_a_row = 0};
inline constexpr DriveReport kNoDriveReport{
    .due_ns = INT64_MIN, .bus_ok = false, .drive_ok = false};

}  // namespace flexarm
