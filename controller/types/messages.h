#pragma once

#include <array>
#include <cstdint>

#include "controller/exchange/history.h"
#include "controller/exchange/latest_value.h"
#include "controller/types/safety_state.h"
#include "controller/types/step_types.h"
#include "controller/types/trip_cause.h"
#include "hal/bus_fault.h"
#include "hal/count_epochs.h"
#include "hal/drive_voltage.h"

// Messages between tasks. Every value is stamped with the instant from which it is valid (History),
// so that the values read depend on the time grid and not on the scheduler.

namespace flexarm {

struct PlannedExperiment;  // controller/tasks/planned_experiment.h

/// A run, as one object: the operator task asks for it with a number, the safety task grants that
/// number or refuses it, and the loop carries out what the permit holds. So what runs is what was
/// granted, and a limit switch may open only in the run that searches for it.
struct RunOrder {
  /// Lives until the loop has begun a run with a higher number. nullptr: the run ends at once.
  const PlannedExperiment* experiment = nullptr;
  LineLevels may_open = 0;  ///< of a homing run: the limit switch that it searches for
};

/// A change of the path of the present run: asked for and granted as a run is. Its experiment is
/// that run's until some sample, and goes on differently from there (motion_change.h).
struct RunChange {
  std::uint32_t number = 0;  ///< of the granted request, ascending; 0: none in this run
  const PlannedExperiment* experiment = nullptr;  ///< lives as RunOrder's
};

/// Homing moves onto a limit switch: its torque limit is reduced.
constexpr bool Homes(const RunOrder& run) noexcept { return run.may_open != 0; }

/// Evidence: the values that caused a trip.
struct Evidence {
  double value;           ///< measured value
  double limit;           ///< limit that it exceeded
  std::uint32_t channel;  ///< joint, counter, strain row, bus or LineTrouble, 1-based; 0: none
  std::uint32_t detail;   ///< of a bus: its BusFault, as bits; else 0
};

/// Control task -> drive. Valid from the instant at which it acts.
struct TorqueCommand {
  std::array<double, 2> torque_nm;
  std::int64_t tick;
};

/// Safety task -> drive, control, operator: permission, renewed every safety tick.
struct Permit {
  SafetyState state;
  TripCause cause;                ///< latched while Tripped
  std::int64_t renewed_ns;        ///< safety tick that wrote it
  std::int64_t running_since_ns;  ///< instant of the last change to Running; INT64_MIN: never
  Evidence evidence;              ///< of `cause`
  LineLevels levels;              ///< digital inputs as read in that tick
  std::uint32_t run_number = 0;   ///< of the granted request, ascending; 0: none yet
  RunOrder run{};                 ///< that run: the present one, or the last
  RunChange change{};             ///< of that run: the last that was granted
  bool reduced = false;           ///< the limits are reduced (WithReducedLimits)
  bool acknowledge = false;       ///< the operator resets: drives acknowledge their faults
};

/// Control task -> safety: heartbeat, and facts that only the loop can detect. Valid from the
/// deadline of the step on.
struct ControlReport {
  std::int64_t tick;    ///< -1: none yet
  std::int64_t due_ns;  ///< when that step was due
  TripCauses faults;
  Evidence evidence;  ///< of the lowest fault
  bool at_rest;
  bool experiment_done;
  int missed_in_a_row;
  bool may_damp = false;     ///< StepOutput::may_damp
  int missed_in_window = 0;  ///< missed deadlines among the last safety.window_periods
};

/// Safety task -> operator: how late the threads of the loop were, since the start.
struct TimingCounts {
  std::uint32_t safety_overruns = 0;         ///< ticks that found a permit older than allowed
  std::int64_t oldest_permit_ns = 0;         ///< the oldest permit that a tick renewed
  std::uint32_t deadlines_missed = 0;        ///< times that too many were missed in a row,
  std::uint32_t deadlines_often_missed = 0;  ///< or in the window

  friend constexpr bool operator==(const TimingCounts&, const TimingCounts&) = default;
};

/// What the drives of a bus, or of a rig, have confirmed.
enum class DrivePower : std::uint8_t {
  kNone,   ///< there are no drives
  kOff,    ///< all are off
  kOn,     ///< all are enabled
  kMixed,  ///< neither, or not known
};

/// That of two buses together.
constexpr DrivePower Joined(DrivePower a, DrivePower b) noexcept {
  if (a == DrivePower::kNone) return b;
  return b == DrivePower::kNone || a == b ? a : DrivePower::kMixed;
}

/// Drive side (plant task, or the buses) -> safety and control: heartbeat and status.
struct DriveReport {
  std::int64_t due_ns;  ///< of its last run
  bool bus_ok;
  bool drive_ok;
  BusFault fault{};                      ///< of the last exchange; none if it succeeded
  std::uint32_t failed = 0;              ///< failed exchanges and attempts to reconnect
  std::uint32_t recovered = 0;           ///< recoveries of a lost bus
  LineLevels levels = kHealthyLevels;    ///< last read by the buses; healthy for other lines
  DrivePower power = DrivePower::kNone;  ///< as confirmed in its last run
  int failed_in_window = 0;              ///< failed exchanges among the last
  int slow_in_window = 0;                ///< those that took longer than the bus declares
  std::uint32_t slow = 0;                ///< the same, since the start
  std::int64_t longest_ns = 0;           ///< longest exchange or attempt to reconnect
  BusFault notice{};                     ///< BusDevice::notice
  CountEpochs count_epochs{};            ///< of its counters
  DriveVoltage voltage{};                ///< as reported in its last run
};

enum class RequestKind : std::uint8_t { kNone, kArm, kRun, kStop, kDisarm, kReset, kChange };

/// Operator -> safety. `not_before_ns` lets an unattended run schedule its requests on the grid.
struct OperatorRequest {
  RequestKind kind;
  std::uint32_t number;  ///< ascending; echoed in the answer, and in the permit of its run
  std::int64_t not_before_ns;
  RunOrder run{};                         ///< of kRun; of kChange the run as it goes on
  std::uint32_t changes = 0;              ///< kChange: the number of the run that it changes,
  std::int64_t not_after_ns = INT64_MAX;  ///< and the last instant at which it may be granted
};

enum class Refusal : std::uint8_t {
  kNone,          ///< accepted
  kWrongState,    ///< the state does not allow it
  kNotAtRest,     ///< the arm is moving
  kCauseRemains,  ///< the trip's cause is still there
  kNoReset,       ///< the physical reset button has not been pressed since the trip
  kUnhealthy,     ///< a fact that would trip is present, or a task has not reported yet
  kCancelled,     ///< a planned arm or run, cancelled by a stop, a disarm or a trip
  kBusy,          ///< another arm, run or reset has not been answered yet
  kShuttingDown,  ///< the daemon ends: nothing may start
  kDrivesOff,     ///< a drive has not confirmed that it is on
  kNotKept,       ///< the latch file could not be written, so a trip would not survive a restart
  kRelayClosed,   ///< relay and pump are off, and a witness does not say that the power is off
  kTooLate,       ///< the path was to change earlier, or the run has ended
};

/// Safety -> operator: answer to a request.
struct RequestAnswer {
  std::uint32_t number;
  RequestKind kind;
  Refusal refusal;
  SafetyState state;   ///< when the request was judged
  TripCauses present;  ///< causes present then
};

/// Channels of the messages: one channel per reader, with enough entries for the slowest reader
/// that meets its deadline.
using PermitHistory = History<Permit, 24>;
using ControlReportHistory = History<ControlReport, 4>;
using DriveReportHistory = History<DriveReport, 4>;
using PermitChannel = LatestValue<PermitHistory>;
using ControlReportChannel = LatestValue<ControlReportHistory>;
using DriveReportChannel = LatestValue<DriveReportHistory>;
using TimingChannel = LatestValue<TimingCounts>;

/// Values of the channels before the first message.
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
