#pragma once

#include <cstdint>

#include "controller/safety/safety_machine.h"
#include "controller/types/messages.h"
#include "hal/sensor_frame.h"

namespace flexarm {

struct SafetyConfig;
struct LoopConfig;

struct SupervisorLimits {
  std::int64_t heartbeat_timeout_ns;  ///< two control periods, for control and drive side
  std::int64_t stop_timeout_ns;       ///< safety.stop_timeout_s
  int missed_deadlines_to_trip;       ///< safety.missed_deadlines_to_trip
  std::int64_t homing_contact_ns;     ///< how long homing may stand on its switch
};

SupervisorLimits MakeSupervisorLimits(const SafetyConfig& safety, const LoopConfig& loop);

/// Which of several buses is meant when the drive side as a whole is in trouble, from 1, and what
/// it met. 0: none, or the drive side is no bus.
struct DriveTroubles {
  struct Trouble {
    std::uint32_t bus = 0;
    BusFault fault{};
  };
  Trouble lost{};                ///< the first that is lost
  Trouble drive{};               ///< the first with a drive's fault
  std::uint32_t oldest_bus = 0;  ///< whose newest report is the oldest
};

/// What one safety tick got to see.
struct SafetyInputs {
  std::int64_t due_ns;
  LineLevels levels;
  ControlReport control;          ///< the one that holds at `due_ns`
  std::int64_t control_alive_ns;  ///< due instant of the newest one published; INT64_MIN: none
  DriveReport drive;              ///< the one that holds at `due_ns`
  std::int64_t drive_alive_ns;    ///< due instant of the newest one published; INT64_MIN: none
  DriveTroubles troubles{};
  RequestKind request;
  SafetyState state;  ///< before this tick
  std::int64_t state_since_ns;
  std::int64_t running_since_ns;  ///< INT64_MIN: never
  LineLevels may_open;            ///< limit switches that a homing run looks for
};

/// Turns what a safety tick sees into the facts of the safety machine: every judgement about time,
/// levels and freshness. Remembers the reset button, and since when homing stands on its switch,
/// nothing else; reads no clock.
///
/// A report counts only while its sender is alive; before the first report of a task, nothing is
/// said about it. Word of rest and of the experiment's end counts only if the step that gave it was
/// due after the machine came to its state, so the last run cannot end the next one. The switch
/// that a homing run looks for may open while it runs, for a bounded time; the others trip as ever.
/// Real-time: safe.  Thread: safety.
class SafetyMonitor {
 public:
  explicit SafetyMonitor(const SupervisorLimits& limits) noexcept : limits_(limits) {}

  /// Once a tick, in order of time.
  SafetyFacts Judge(const SafetyInputs& in) noexcept;

  /// The values behind a cause that Judge found present in `in`, or behind kStopTimeout. Times in
  /// s.
  Evidence EvidenceOf(TripCause cause, const SafetyInputs& in) const noexcept;

 private:
  /// True while homing stands on the switch that it looks for, and has not for too long.
  bool HomingContact(const SafetyInputs& in) noexcept;

  SupervisorLimits limits_;
  std::int64_t contact_since_ns_ = INT64_MAX;
  bool all_reported_ = false;
  bool button_was_down_ = true;  // a button that is down from the start has not been pressed
  bool reset_pressed_ = false;
};

}  // namespace flexarm
