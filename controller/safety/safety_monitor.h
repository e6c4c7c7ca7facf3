#pragma once

#include <cstdint>
#include <optional>

#include "controller/safety/line_calls.h"
#include "controller/safety/power_path.h"
#include "controller/safety/relay_contact.h"
#include "controller/safety/safety_machine.h"
#include "controller/types/messages.h"
#include "hal/sensor_frame.h"

namespace flexarm {

struct SafetyConfig;
struct LoopConfig;

/// Time limits of the safety monitor.
struct MonitorLimits {
  std::int64_t heartbeat_timeout_ns;  ///< two control periods, for control and drive side
  std::int64_t stop_timeout_ns;       ///< safety.stop_timeout_s
  std::int64_t fault_stop_ns;         ///< safety.fault_stop_s
  int missed_deadlines_to_trip;       ///< safety.missed_deadlines_to_trip
  std::int64_t homing_contact_ns;     ///< how long a homing run may be on its switch in all
  std::int64_t lines_stall_ns;        ///< longest call of the lines: safety.permit_timeout_ms
  std::int64_t overrun_ns;            ///< safety.overrun_to_trip_ms
  int missed_in_window;               ///< safety.missed_deadlines_in_window
  int failed_in_window;               ///< safety.failed_exchanges_in_window
  int slow_in_window;                 ///< safety.slow_exchanges_in_window
  /// False: late threads are counted but do not trip, because the arm is simulated in process.
  bool late_threads_trip = true;
  PowerPathLimits power{};  ///< of the drives' voltage as a witness
};

MonitorLimits MakeMonitorLimits(const SafetyConfig& safety, const LoopConfig& loop,
                                bool late_threads_trip,
                                const std::optional<DriveVoltageTimes>& voltage = std::nullopt);

/// The bus behind a fault of the drive side, numbered from 1, and its fault. 0: none, or the drive
/// side has no bus.
struct DriveTroubles {
  struct Trouble {
    std::uint32_t bus = 0;
    BusFault fault{};
  };
  Trouble lost{};                ///< the first bus that is lost
  Trouble drive{};               ///< the first bus with a drive fault
  Trouble unreliable{};          ///< the bus with the most failed exchanges in its window
  Trouble slow{};                ///< the bus with the most slow exchanges in its window
  std::uint32_t oldest_bus = 0;  ///< the bus whose newest report is the oldest
};

/// Inputs of one safety tick.
struct SafetyInputs {
  std::int64_t due_ns;
  LineLevels levels;              ///< what the lines count as (LineFilter)
  ControlReport control;          ///< the one that holds at `due_ns`
  std::int64_t control_alive_ns;  ///< due instant of the newest one published; INT64_MIN: none
  DriveReport drive;              ///< the one that holds at `due_ns`
  std::int64_t drive_alive_ns;    ///< due instant of the newest one published; INT64_MIN: none
  DriveTroubles troubles{};
  RequestKind request;
  bool shutting_down = false;  ///< the daemon ends
  SafetyState state;           ///< before this tick
  std::int64_t state_since_ns;
  std::int64_t running_since_ns;  ///< INT64_MIN: never
  LineLevels may_open;            ///< the limit switch that the run searches for (RunOrder)
  bool levels_known = true;       ///< false: too few samples to say that a switch is open
  LineCalls line_calls{};
  std::int64_t permit_age_ns = 0;  ///< of the permit that this tick renews; 0: it is the first
  RelayContact relay = RelayContact::kNone;  ///< it was told RelayClosed(state)
};

/// Safety monitor: derives the inputs of the safety state machine from line levels and task
/// reports, with all checks of time, levels and freshness. Its only memory is the reset button, the
/// first reports, the causes with which FaultStopping began, how long homing has been on its
/// switch, which ticks the lines were slow in, since when relay or voltage contradict the
/// command, when the shutdown began, and how often threads were late. Reads no clock.
///
/// A report counts only while its sender is alive; no cause is derived from a task before its first
/// report, nor from a switch before its level is known: until both are, `all_reported` is 0. While
/// Stopping or FaultStopping, `at_rest` counts only from a step that was due after the stop,
/// `drives_off` only from a report of the state at hand, and `experiment_done` only from a step
/// that was due after the run began, so the last run cannot end the next one. The switch that a
/// homing run searches for may open while that run is Running, for a bounded time in all: a switch
/// that bounces gains none. The other switches trip as always.
///
/// A shutdown whose arm still has power kShutdownMarginNs after the longest stop trips.
/// Real-time: safe.  Thread: safety.
class SafetyMonitor {
 public:
  /// Disarming waits so long for the drives to confirm that they are off.
  static constexpr std::int64_t kDisarmNs = 100'000'000;

  /// The shutdown may take so much longer than safety.stop_timeout_s. The operator task waits
  /// longer (Shutdown::LimitNs), so that the relay is open before the threads end.
  static constexpr std::int64_t kShutdownMarginNs = 500'000'000;

  explicit SafetyMonitor(const MonitorLimits& limits) noexcept
      : limits_(limits), line_calls_(limits.lines_stall_ns), power_path_(limits.power) {}

  /// Once per tick, in order of time.
  SafetyFacts Judge(const SafetyInputs& in) noexcept;

  /// Value and limit behind a cause that Judge found present in `in`, or behind kStopTimeout. Times
  /// in s.
  Evidence EvidenceOf(TripCause cause, const SafetyInputs& in) const noexcept;

  /// Late threads so far, whether they trip or not.
  const TimingCounts& timing() const noexcept { return timing_; }

 private:
  /// Causes by which threads are late, whether they trip or not; counts those that are new.
  TripCauses LateThreads(const SafetyInputs& in, bool control_alive) noexcept;
  bool ShutdownExpired(const SafetyInputs& in) noexcept;
  std::int64_t ShutdownLimitNs() const noexcept {
    return limits_.stop_timeout_ns + kShutdownMarginNs;
  }
  /// True while homing is on the switch that it searches for, within the permitted time.
  bool HomingContact(const SafetyInputs& in) noexcept;
  /// Longest time in the present state; INT64_MAX: without limit.
  std::int64_t StateLimitNs(SafetyState state) const noexcept;
  bool LinesFail(const SafetyInputs& in) noexcept;
  bool MayDamp(const SafetyInputs& in, TripCauses present, bool control_alive) noexcept;

  MonitorLimits limits_;
  LineCallMonitor line_calls_;
  RelayContactMonitor relay_;
  PowerPathMonitor power_path_;
  Evidence lines_evidence_{};      // of kSafetyLines, in the last tick
  std::int64_t contact_ns_ = 0;    // of the present homing run
  std::int64_t looked_ns_ = 0;     // the tick before
  TripCauses present_before_ = 0;  // the tick before
  TripCauses fault_causes_ = 0;    // those with which FaultStopping began
  TripCauses late_before_ = 0;     // LateThreads, the tick before
  TimingCounts timing_{};
  std::int64_t shutdown_since_ns_ = INT64_MIN;
  bool all_reported_ = false;
  bool button_was_down_ = true;  // a button that is down from the start does not count
  bool reset_pressed_ = false;
};

}  // namespace flexarm
